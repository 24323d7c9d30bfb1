#include "common/bus/cyclone/listeners.h"

#include "common/bus/cyclone/entities.h"

namespace conav::bus {
namespace {

EndpointEvents& WriterEvents(void* argument) { return *static_cast<EndpointEvents*>(argument); }
CycloneReader& ReaderOf(void* argument) { return *static_cast<CycloneReader*>(argument); }

void OnPublicationMatched(dds_entity_t, dds_publication_matched_status_t status, void* argument) {
  WriterEvents(argument).Matched(status.current_count_change);
}

void OnOfferedIncompatibleQos(dds_entity_t, dds_offered_incompatible_qos_status_t status,
                              void* argument) {
  WriterEvents(argument).IncompatibleQos(status.last_policy_id);
}

void OnData(dds_entity_t reader, void* argument) { ReaderOf(argument).TakeAll(reader); }

void OnSubscriptionMatched(dds_entity_t, dds_subscription_matched_status_t status, void* argument) {
  ReaderOf(argument).events().Matched(status.current_count_change);
}

void OnLiveliness(dds_entity_t, dds_liveliness_changed_status_t status, void* argument) {
  ReaderOf(argument).events().Liveliness(status.alive_count_change, status.not_alive_count_change);
}

void OnRequestedIncompatibleQos(dds_entity_t, dds_requested_incompatible_qos_status_t status,
                                void* argument) {
  ReaderOf(argument).events().IncompatibleQos(status.last_policy_id);
}

}  // namespace

ListenerPointer WriterListener(EndpointEvents& events) {
  ListenerPointer listener(dds_create_listener(&events), dds_delete_listener);
  dds_lset_publication_matched(listener.get(), OnPublicationMatched);
  dds_lset_offered_incompatible_qos(listener.get(), OnOfferedIncompatibleQos);
  return listener;
}

ListenerPointer ReaderListener(CycloneReader& reader) {
  ListenerPointer listener(dds_create_listener(&reader), dds_delete_listener);
  dds_lset_data_available(listener.get(), OnData);
  dds_lset_subscription_matched(listener.get(), OnSubscriptionMatched);
  dds_lset_liveliness_changed(listener.get(), OnLiveliness);
  dds_lset_requested_incompatible_qos(listener.get(), OnRequestedIncompatibleQos);
  return listener;
}

}  // namespace conav::bus
