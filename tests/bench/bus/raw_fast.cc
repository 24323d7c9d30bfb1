// Fast DDS by its own C++ API and the type of fastddsgen.
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>

#include "bench/bus/stack.h"
#include "common/bus/fast/participant.h"
#include "test_typesPubSubTypes.h"

namespace conav::bench {
namespace {

namespace dds = eprosima::fastdds::dds;
using conav_test::msg::Blob;
using eprosima::fastrtps::types::ReturnCode_t;

struct Participant {
  explicit Participant(const StackOptions& options) : bus_options(BusOptions(options)) {
    handle = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<dds::DomainId_t>(options.domain_id),
        bus::FastParticipantQos("bench", bus::ResolveNetwork(bus_options), bus_options.lease_s));
    type.register_type(handle);
    publisher = handle->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber = handle->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~Participant() {
    handle->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(handle);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds::Topic* Topic(const char* name) {
    return handle->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  }
  dds::DataWriter* Writer(const char* topic, const bus::Qos& qos) {
    return publisher->create_datawriter(Topic(topic), bus::FastWriterQos(qos, bus_options.lease_s));
  }
  dds::DataReader* Reader(const char* topic, const bus::Qos& qos,
                          dds::DataReaderListener* listener) {
    return subscriber->create_datareader(Topic(topic), bus::FastReaderQos(qos), listener,
                                         dds::StatusMask::data_available());
  }

  bus::ParticipantOptions bus_options;
  dds::TypeSupport type{new conav_test::msg::BlobPubSubType()};
  dds::DomainParticipant* handle;
  dds::Publisher* publisher;
  dds::Subscriber* subscriber;
};

/// Takes what there is and hands it on.
class Taker : public dds::DataReaderListener {
 public:
  explicit Taker(std::function<void(Blob&)> use) : use_(std::move(use)) {}
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(&blob_, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) use_(blob_);
    }
  }

 private:
  Blob blob_;
  std::function<void(Blob&)> use_;
};

class RawFastPinger final : public Pinger {
 public:
  RawFastPinger(const StackOptions& options, OnPong on_pong)
      : on_data_([on_pong = std::move(on_pong)](Blob& blob) { on_pong(blob.id()); }),
        participant_(options),
        ping_(participant_.Writer(kPingTopic, kPingQos)),
        flood_(participant_.Writer(kFloodTopic, kFloodQos)) {
    participant_.Reader(kPongTopic, kPingQos, &on_data_);
  }

  void Prepare(std::size_t size) override { message_.data(std::vector<std::uint8_t>(size, 1)); }
  void SendPing(std::uint64_t id) override {
    message_.id(id);
    ping_->write(&message_);
  }
  bool SendFlood(std::uint64_t id) override {
    message_.id(id);
    return flood_->write(&message_);
  }

 private:
  Blob message_;
  Taker on_data_;
  Participant participant_;
  dds::DataWriter* ping_;
  dds::DataWriter* flood_;
};

class RawFastEcho final : public Echo {
 public:
  explicit RawFastEcho(const StackOptions& options)
      : on_ping_([this](Blob& blob) { pong_->write(&blob); }),
        on_flood_([this](Blob& blob) {
          if (blob.id() == kEndOfFlood) pong_->write(&blob);
        }),
        participant_(options),
        pong_(participant_.Writer(kPongTopic, kPingQos)) {
    participant_.Reader(kPingTopic, kPingQos, &on_ping_);
    participant_.Reader(kFloodTopic, kFloodQos, &on_flood_);
  }

 private:
  Taker on_ping_;
  Taker on_flood_;
  Participant participant_;
  dds::DataWriter* pong_;
};

}  // namespace

std::unique_ptr<Pinger> MakeRawFastPinger(const StackOptions& options, Pinger::OnPong on_pong) {
  return std::make_unique<RawFastPinger>(options, std::move(on_pong));
}

std::unique_ptr<Echo> MakeRawFastEcho(const StackOptions& options) {
  return std::make_unique<RawFastEcho>(options);
}

}  // namespace conav::bench
