#include "common/bus/backend.h"

#include <dds/dds.h>

#include "common/bus/cyclone/domain.h"
#include "common/bus/cyclone/entities.h"

namespace conav::bus {
namespace {

/// ROS 2 recognises its participants by this user data.
constexpr std::string_view kRosUserData = "enclave=/;";

dds_entity_t CreateParticipant(int domain_id) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_userdata(qos, kRosUserData.data(), kRosUserData.size());
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(domain_id), qos, nullptr);
  dds_delete_qos(qos);
  return participant;
}

class CycloneBackend final : public Backend {
 public:
  CycloneBackend(const std::string& node_name, const ParticipantOptions& options)
      : domain_(CycloneDomain::Open(
            options.domain_id, CycloneConfiguration(ResolveNetwork(options), options.lease_s))),
        participant_(CreateParticipant(options.domain_id), "a participant"),
        lease_s_(options.lease_s),
        graph_(node_name, options.ros_distribution, participant_.guid()) {
    graph_.Start(std::make_unique<CycloneWriter>(Context(nullptr), graph_.endpoint()));
  }

  std::unique_ptr<Writer> CreateWriter(const EndpointOptions& options) override {
    return std::make_unique<CycloneWriter>(Context(&graph_), options);
  }
  std::unique_ptr<Reader> CreateReader(const EndpointOptions& options, Sink sink) override {
    return std::make_unique<CycloneReader>(Context(&graph_), options, std::move(sink));
  }
  std::vector<Event> TakeEvents() override { return events_.Take(); }

 private:
  CycloneContext Context(RosGraph* graph) {
    return {participant_.handle(), lease_s_, events_, graph};
  }

  std::shared_ptr<CycloneDomain> domain_;
  CycloneEntity participant_;
  double lease_s_;
  EventLog events_;
  RosGraph graph_;
};

}  // namespace

std::unique_ptr<Backend> MakeCycloneBackend(const std::string& node_name,
                                            const ParticipantOptions& options) {
  return std::make_unique<CycloneBackend>(node_name, options);
}

}  // namespace conav::bus
