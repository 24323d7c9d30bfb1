#include <cstdint>
#include <string_view>

#include "common/runtime/result.h"
#include "operator/foxglove/client_feed.h"

/// Whatever a client of Foxglove's protocol sends: ClientFeed takes it, and what it asks is read.
///
/// Input: messages, each behind its length in two bytes, low byte first, and a byte, odd = text.
namespace conav::foxglove {
namespace {

std::string_view Cut(std::string_view& from, std::size_t size) {
  const std::string_view part = from.substr(0, size);
  from.remove_prefix(part.size());
  return part;
}

std::uint8_t CutByte(std::string_view& from) {
  const std::string_view byte = Cut(from, 1);
  return byte.empty() ? 0 : static_cast<std::uint8_t>(byte.front());
}

Catalog Everything() {
  Catalog catalog;
  catalog.channels = {
      {{1, "/r1/state", "conav_msgs/msg/RobotState", ""}, Backlog::kQueue, 1},
      {{2, "/r1/camera", "sensor_msgs/msg/CompressedImage", ""}, Backlog::kNewest, 0}};
  catalog.services = {{1, "/r1/stop"}, {2, "/r1/resume"}};
  catalog.goal_topics = {"/r1/goal_pose"};
  catalog.parameters = {{"/operator.a", "1"}};
  return catalog;
}

/// Counts what the feed says of its subscriptions, and reads what it asks.
class Host final : public FeedHost {
 public:
  std::vector<ChannelMessage> Join(std::uint32_t channel) override {
    ++subscribed_;
    const auto payload = std::make_shared<const std::vector<std::uint8_t>>(10);
    return {{channel, 1, payload}, {channel, 2, payload}};
  }
  void Left(std::uint32_t) override { --subscribed_; }
  bool Ask(std::uint64_t, Asked asked) override {
    if (const auto* goal = std::get_if<PublishGoal>(&asked)) {
      static_cast<void>(PoseFromJson(goal->payload));
      static_cast<void>(TextFromCdr(goal->payload));
    } else if (const auto* call = std::get_if<CallService>(&asked)) {
      DEMAND(!TriggerResponseBytes(*call, true, call->payload).empty());
    }
    return true;
  }
  std::shared_ptr<const std::string> graph() override { return nullptr; }
  void CountSkipped(std::uint64_t, std::uint64_t) override {}

  int subscribed() const { return subscribed_; }

 private:
  int subscribed_ = 0;
};

void TakeAll(std::string_view input) {
  static const Catalog catalog = Everything();
  Host host;
  {
    const Clock::TimePoint now{std::chrono::seconds(100)};
    ClientFeed feed(catalog, host, 1, console::ROLE_OPERATOR, {.message_burst = 1000}, now);
    while (!input.empty()) {
      std::size_t size = CutByte(input);
      size += std::size_t{256} * CutByte(input);
      const bool is_text = CutByte(input) % 2 == 1;
      feed.Take(Cut(input, size), is_text, now);
      for (const std::uint32_t channel : {1U, 2U}) {
        feed.Add({channel, 1, std::make_shared<const std::vector<std::uint8_t>>(size)});
      }
      DEMAND(host.subscribed() >= 0 && host.subscribed() <= 2, host.subscribed());
      while (feed.Next(now)) {
      }
      DEMAND(feed.queued_bytes() == 0, feed.queued_bytes());
    }
  }
  DEMAND(host.subscribed() == 0, host.subscribed());
}

}  // namespace
}  // namespace conav::foxglove

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  conav::foxglove::TakeAll({reinterpret_cast<const char*>(data), size});
  return 0;
}
