// Cyclone DDS by its own C API and the C type of idlc.
#include <dds/dds.h>

#include <array>
#include <deque>
#include <vector>

#include "bench/bus/stack.h"
#include "common/bus/cyclone/backend.h"
#include "test_types.h"

namespace conav::bench {
namespace {

using Blob = conav_test_msg_Blob;
using QosPointer = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

QosPointer MakeQos(const bus::Qos& qos) {
  QosPointer result(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(result.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(result.get(), qos.depth > 0 ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL,
                   qos.depth);
  return result;
}

class RawCyclone final : public Stack {
 public:
  explicit RawCyclone(const StackOptions& options) {
    const bus::ParticipantOptions bus = options.OnLoopback();
    const auto id = static_cast<dds_domainid_t>(options.domain_id);
    domain_ = dds_create_domain(
        id, bus::CycloneConfiguration(bus::ResolveNetwork(bus), bus.lease_s).c_str());
    participant_ = dds_create_participant(id, nullptr, nullptr);
  }
  ~RawCyclone() override { dds_delete(domain_); }
  RawCyclone(const RawCyclone&) = delete;
  RawCyclone& operator=(const RawCyclone&) = delete;

  void Offer(const Channel& channel) override {
    writers_[channel.index] =
        dds_create_writer(participant_, Topic(channel), MakeQos(channel.qos).get(), nullptr);
  }
  void Listen(const Channel& channel, OnMessage on_message) override {
    handlers_.push_back(std::move(on_message));
    dds_listener_t* listener = dds_create_listener(&handlers_.back());
    dds_lset_data_available(listener, TakeAll);
    dds_create_reader(participant_, Topic(channel), MakeQos(channel.qos).get(), listener);
    dds_delete_listener(listener);
  }
  void Prepare(std::size_t size) override {
    bytes_.assign(size, 1);
    message_.data._buffer = bytes_.data();
    message_.data._length = static_cast<std::uint32_t>(size);
    message_.data._maximum = message_.data._length;
  }
  bool Send(const Channel& channel, std::uint64_t id) override {
    message_.id = id;
    return dds_write(writers_[channel.index], &message_) == DDS_RETCODE_OK;
  }
  void SendBack(const Channel& channel, const void* message) override {
    dds_write(writers_[channel.index], message);
  }

 private:
  dds_entity_t Topic(const Channel& channel) const {
    return dds_create_topic(participant_, &conav_test_msg_Blob_desc, channel.topic, nullptr,
                            nullptr);
  }
  static void TakeAll(dds_entity_t reader, void* handler) {
    constexpr int kBatch = 16;
    void* samples[kBatch] = {};
    dds_sample_info_t infos[kBatch];
    const int count = dds_take(reader, samples, infos, kBatch, kBatch);
    for (int i = 0; i < count; ++i) {
      if (!infos[i].valid_data) continue;
      (*static_cast<OnMessage*>(handler))(static_cast<Blob*>(samples[i])->id, samples[i]);
    }
    dds_return_loan(reader, samples, count);
  }

  std::vector<std::uint8_t> bytes_;
  Blob message_{};
  std::deque<OnMessage> handlers_;
  std::array<dds_entity_t, kChannels> writers_{};
  dds_entity_t domain_;
  dds_entity_t participant_;
};

}  // namespace

std::unique_ptr<Stack> MakeRawCyclone(const StackOptions& options) {
  return std::make_unique<RawCyclone>(options);
}

}  // namespace conav::bench
