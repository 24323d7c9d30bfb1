#include "bench/bus/stack.h"

#include "common/bus/backend.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "support/test_messages.h"

namespace conav::bench {
namespace {

using conav_test::msg::Blob;

constexpr bus::Topic<Blob> kPing{kPingTopic, kPingQos};
constexpr bus::Topic<Blob> kPong{kPongTopic, kPingQos};
constexpr bus::Topic<Blob> kFlood{kFloodTopic, kFloodQos};

class BusPinger final : public Pinger {
 public:
  BusPinger(const StackOptions& options, OnPong on_pong)
      : participant_("bench", BusOptions(options)),
        ping_(participant_, kPing),
        flood_(participant_, kFlood),
        pong_(participant_, kPong, {},
              [on_pong = std::move(on_pong)](Blob&& pong) { on_pong(pong.id()); }) {}

  void Prepare(std::size_t size) override { message_.data(test::Pattern(1, size)); }

  void SendPing(std::uint64_t id) override {
    message_.id(id);
    static_cast<void>(ping_.Publish(message_));
  }

  bool SendFlood(std::uint64_t id) override {
    message_.id(id);
    return flood_.Publish(message_).has_value();
  }

 private:
  Blob message_;
  bus::Participant participant_;
  bus::Publisher<Blob> ping_;
  bus::Publisher<Blob> flood_;
  bus::Subscriber<Blob> pong_;
};

class BusEcho final : public Echo {
 public:
  explicit BusEcho(const StackOptions& options)
      : participant_("bench_echo", BusOptions(options)),
        pong_(participant_, kPong),
        ping_(participant_, kPing, {},
              [this](Blob&& ping) { static_cast<void>(pong_.Publish(ping)); }),
        flood_(participant_, kFlood, {}, [this](Blob&& blob) {
          if (blob.id() == kEndOfFlood) static_cast<void>(pong_.Publish(blob));
        }) {}

 private:
  bus::Participant participant_;
  bus::Publisher<Blob> pong_;
  bus::Subscriber<Blob> ping_;
  bus::Subscriber<Blob> flood_;
};

}  // namespace

bus::ParticipantOptions BusOptions(const StackOptions& options) {
  bus::ParticipantOptions result;
  result.vendor = bus::ParseVendor(options.vendor);
  result.domain_id = options.domain_id;
  result.interface = "lo";
  return result;
}

std::unique_ptr<Pinger> MakePinger(const StackOptions& options, Pinger::OnPong on_pong) {
  if (!options.raw) return std::make_unique<BusPinger>(options, std::move(on_pong));
  return options.vendor == Name(bus::Vendor::kFastDds)
             ? MakeRawFastPinger(options, std::move(on_pong))
             : MakeRawCyclonePinger(options, std::move(on_pong));
}

std::unique_ptr<Echo> MakeEcho(const StackOptions& options) {
  if (!options.raw) return std::make_unique<BusEcho>(options);
  return options.vendor == Name(bus::Vendor::kFastDds) ? MakeRawFastEcho(options)
                                                       : MakeRawCycloneEcho(options);
}

}  // namespace conav::bench
