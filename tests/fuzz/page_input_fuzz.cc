#include <google/protobuf/stubs/logging.h>

#include <cstdint>
#include <string_view>

#include "common/runtime/result.h"
#include "operator/console/console_messages.h"
#include "operator/gateway/page_feed.h"

/// Whatever a page sends: PageFeed takes it, and what it asks is converted for the service.
///
/// Input: a byte, odd = the page has said hello; then messages, each behind its length in two bytes,
/// low byte first.
namespace conav::operators {
namespace {

std::string_view Cut(std::string_view& from, std::size_t size) {
  const std::string_view part = from.substr(0, size);
  from.remove_prefix(part.size());
  return part;
}

std::string_view CutMessage(std::string_view& from) {
  const std::string_view length = Cut(from, 2);
  std::size_t size = 0;
  for (std::size_t i = 0; i < length.size(); ++i) {
    size |= static_cast<std::size_t>(static_cast<std::uint8_t>(length[i])) << (8 * i);
  }
  return Cut(from, size);
}

std::string HelloBytes() {
  console::ClientMessage message;
  message.mutable_hello()->set_name("anna");
  message.mutable_hello()->set_instance("0123456789abcdef");
  return message.SerializeAsString();
}

struct World {
  World() {
    options.message_rate = 10000.0;
    options.message_burst = 1000;
    console::Update update;
    update.mutable_session()->set_name("fuzz");
    updates.Put("session", update);
    console::Frame frame;
    frame.set_robot("r1");
    frames.Put(frame);
  }

  GatewayOptions options;
  UpdateLog updates;
  FrameSlots frames;
  console::Welcome welcome;
  AccessControl access{""};
};

void Use(const PageEvent& event) {
  DEMAND(!event.who.client.empty());
  const auto* asked = std::get_if<PageAsked>(&event.body);
  if (asked == nullptr) return;
  DEMAND(asked->round_trip_s >= 0.0, asked->round_trip_s);
  CheckNow(event.who, *asked, 1000.0, 1.0);
  const auto request = ToOperatorRequest(asked->request, event.who.client, SimTime{1});
  if (request) {
    DEMAND(request->request_id == asked->request.id(), request->request_id);
  } else {
    DEMAND(!request.error().text.empty());
  }
}

/// What the page is sent in turn.
void Drain(PageFeed& feed, Clock::TimePoint now) {
  while (const auto bytes = feed.Next(now)) {
    console::ServerMessage message;
    DEMAND(message.ParseFromString(*bytes), bytes->size());
    DEMAND(message.body_case() != console::ServerMessage::BODY_NOT_SET);
  }
}

void TakeAll(std::string_view input) {
  World world;
  FakeClock clock;
  PageFeed feed({world.options, world.updates, world.frames, world.welcome, world.access,
                 [] { return true; }},
                1, clock.Now());
  const std::string_view first = Cut(input, 1);
  if (!first.empty() && first[0] % 2 != 0) feed.Take(HelloBytes(), clock.Now(), 1000.0);
  while (!input.empty()) {
    for (const PageEvent& event : feed.Take(CutMessage(input), clock.Now(), 1000.0)) Use(event);
    clock.Advance(std::chrono::milliseconds(20));
    Drain(feed, clock.Now());
  }
  clock.Advance(PageFeed::kHelloLimit);
  Drain(feed, clock.Now());
  DEMAND(feed.finished() || feed.has_joined());
}

}  // namespace
}  // namespace conav::operators

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  google::protobuf::SetLogHandler(nullptr);  // it tells of each text that is no UTF-8
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  conav::operators::TakeAll({reinterpret_cast<const char*>(data), size});
  return 0;
}
