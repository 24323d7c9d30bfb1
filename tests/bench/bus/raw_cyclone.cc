// Cyclone DDS by its own C API and the C type of idlc.
#include <dds/dds.h>

#include "bench/bus/stack.h"
#include "common/bus/cyclone/backend.h"
#include "test_types.h"

namespace conav::bench {
namespace {

using Blob = conav_test_msg_Blob;

struct Participant {
  explicit Participant(const StackOptions& options) {
    const bus::ParticipantOptions bus_options = BusOptions(options);
    const auto id = static_cast<dds_domainid_t>(options.domain_id);
    domain = dds_create_domain(
        id,
        bus::CycloneConfiguration(bus::ResolveNetwork(bus_options), bus_options.lease_s).c_str());
    handle = dds_create_participant(id, nullptr, nullptr);
  }
  ~Participant() { dds_delete(domain); }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds_entity_t Topic(const char* name) {
    return dds_create_topic(handle, &conav_test_msg_Blob_desc, name, nullptr, nullptr);
  }

  dds_entity_t domain;
  dds_entity_t handle;
};

dds_qos_t* MakeQos(const bus::Qos& qos) {
  dds_qos_t* result = dds_create_qos();
  dds_qset_reliability(result, DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(result, qos.depth > 0 ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, qos.depth);
  return result;
}

dds_entity_t MakeWriter(Participant& participant, const char* topic, const bus::Qos& qos) {
  dds_qos_t* writer_qos = MakeQos(qos);
  const dds_entity_t writer =
      dds_create_writer(participant.handle, participant.Topic(topic), writer_qos, nullptr);
  dds_delete_qos(writer_qos);
  return writer;
}

dds_entity_t MakeReader(Participant& participant, const char* topic, const bus::Qos& qos,
                        dds_on_data_available_fn callback, void* argument) {
  dds_listener_t* listener = dds_create_listener(argument);
  dds_lset_data_available(listener, callback);
  dds_qos_t* reader_qos = MakeQos(qos);
  const dds_entity_t reader =
      dds_create_reader(participant.handle, participant.Topic(topic), reader_qos, listener);
  dds_delete_qos(reader_qos);
  dds_delete_listener(listener);
  return reader;
}

template <class Use>
void TakeAll(dds_entity_t reader, Use&& use) {
  constexpr int kBatch = 16;
  void* samples[kBatch] = {};
  dds_sample_info_t infos[kBatch];
  const int count = dds_take(reader, samples, infos, kBatch, kBatch);
  for (int i = 0; i < count; ++i) {
    if (infos[i].valid_data) use(*static_cast<Blob*>(samples[i]));
  }
  dds_return_loan(reader, samples, count);
}

class RawCyclonePinger final : public Pinger {
 public:
  RawCyclonePinger(const StackOptions& options, OnPong on_pong)
      : on_pong_(std::move(on_pong)),
        participant_(options),
        ping_(MakeWriter(participant_, kPingTopic, kPingQos)),
        flood_(MakeWriter(participant_, kFloodTopic, kFloodQos)) {
    MakeReader(participant_, kPongTopic, kPingQos, OnData, this);
  }

  void Prepare(std::size_t size) override {
    bytes_.assign(size, 1);
    message_.data._buffer = bytes_.data();
    message_.data._length = static_cast<std::uint32_t>(size);
    message_.data._maximum = message_.data._length;
  }

  void SendPing(std::uint64_t id) override {
    message_.id = id;
    dds_write(ping_, &message_);
  }

  bool SendFlood(std::uint64_t id) override {
    message_.id = id;
    return dds_write(flood_, &message_) == DDS_RETCODE_OK;
  }

 private:
  static void OnData(dds_entity_t reader, void* self) {
    TakeAll(reader,
            [&](const Blob& blob) { static_cast<RawCyclonePinger*>(self)->on_pong_(blob.id); });
  }

  OnPong on_pong_;
  std::vector<std::uint8_t> bytes_;
  Blob message_{};
  Participant participant_;
  dds_entity_t ping_;
  dds_entity_t flood_;
};

class RawCycloneEcho final : public Echo {
 public:
  explicit RawCycloneEcho(const StackOptions& options)
      : participant_(options), pong_(MakeWriter(participant_, kPongTopic, kPingQos)) {
    MakeReader(participant_, kPingTopic, kPingQos, OnPing, this);
    MakeReader(participant_, kFloodTopic, kFloodQos, OnFlood, this);
  }

 private:
  static void OnPing(dds_entity_t reader, void* self) {
    TakeAll(reader,
            [&](const Blob& blob) { dds_write(static_cast<RawCycloneEcho*>(self)->pong_, &blob); });
  }
  static void OnFlood(dds_entity_t reader, void* self) {
    TakeAll(reader, [&](const Blob& blob) {
      if (blob.id == kEndOfFlood) dds_write(static_cast<RawCycloneEcho*>(self)->pong_, &blob);
    });
  }

  Participant participant_;
  dds_entity_t pong_;
};

}  // namespace

std::unique_ptr<Pinger> MakeRawCyclonePinger(const StackOptions& options, Pinger::OnPong on_pong) {
  return std::make_unique<RawCyclonePinger>(options, std::move(on_pong));
}

std::unique_ptr<Echo> MakeRawCycloneEcho(const StackOptions& options) {
  return std::make_unique<RawCycloneEcho>(options);
}

}  // namespace conav::bench
