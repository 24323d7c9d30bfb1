// Fast DDS by its own C++ API and the type of fastddsgen.
#include <array>
#include <deque>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "bench/bus/stack.h"
#include "common/bus/fast/participant.h"
#include "test_typesPubSubTypes.h"

namespace conav::bench {
namespace {

namespace dds = eprosima::fastdds::dds;
using conav_test::msg::Blob;
using eprosima::fastrtps::types::ReturnCode_t;

/// Takes what there is and hands it on.
class Taker : public dds::DataReaderListener {
 public:
  explicit Taker(Stack::OnMessage use) : use_(std::move(use)) {}
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(&blob_, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) use_(blob_.id(), &blob_);
    }
  }

 private:
  Blob blob_;
  Stack::OnMessage use_;
};

class RawFast final : public Stack {
 public:
  explicit RawFast(const StackOptions& options) : bus_(options.OnLoopback()) {
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<dds::DomainId_t>(options.domain_id),
        bus::FastParticipantQos("bench", bus::ResolveNetwork(bus_), bus_.lease_s));
    type_.register_type(participant_);
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~RawFast() override {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  RawFast(const RawFast&) = delete;
  RawFast& operator=(const RawFast&) = delete;

  void Offer(const Channel& channel) override {
    writers_[channel.index] = publisher_->create_datawriter(
        Topic(channel), bus::FastWriterQos(channel.qos, true, bus_.lease_s));
  }
  void Listen(const Channel& channel, OnMessage on_message) override {
    takers_.emplace_back(std::move(on_message));
    subscriber_->create_datareader(Topic(channel), bus::FastReaderQos(channel.qos), &takers_.back(),
                                   dds::StatusMask::data_available());
  }
  void Prepare(std::size_t size) override { message_.data(std::vector<std::uint8_t>(size, 1)); }
  bool Send(const Channel& channel, std::uint64_t id) override {
    message_.id(id);
    return writers_[channel.index]->write(&message_);
  }
  void SendBack(const Channel& channel, const void* message) override {
    writers_[channel.index]->write(const_cast<void*>(message));
  }

 private:
  dds::Topic* Topic(const Channel& channel) {
    return participant_->create_topic(channel.topic, type_.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  }

  bus::ParticipantOptions bus_;
  Blob message_;
  std::deque<Taker> takers_;
  std::array<dds::DataWriter*, kChannels> writers_{};
  dds::TypeSupport type_{new conav_test::msg::BlobPubSubType()};
  dds::DomainParticipant* participant_;
  dds::Publisher* publisher_;
  dds::Subscriber* subscriber_;
};

}  // namespace

std::unique_ptr<Stack> MakeRawFast(const StackOptions& options) {
  return std::make_unique<RawFast>(options);
}

}  // namespace conav::bench
