#pragma once

#include <fmt/core.h>
#include <google/protobuf/text_format.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/text.h"
#include "operator/gateway/page_feed.h"
#include "unit/operator/support/updates.h"

namespace conav::operators {

/// One page without a socket, and what all pages share.
struct PageBench {
  PageBench() {
    welcome.set_run("run");
    welcome.mutable_limits()->set_edit_cells(100);
    updates.Put("a", Said("a", "1"));
    Connect();
  }

  void Connect() {
    const PageContext context{options, updates, frames,
                              welcome, access,  [this] { return has_room; }};
    feed.emplace(context, ++connections, clock.Now(), "192.0.2.1");
  }

  static console::Hello Hello() {
    console::Hello hello;
    hello.set_name("anna");
    hello.set_instance("0123456789abcdef");
    return hello;
  }

  std::vector<PageEvent> Send(const console::ClientMessage& message) {
    return feed->Take(message.SerializeAsString(), clock.Now(), 1000.0);
  }
  std::vector<PageEvent> Send(const console::Hello& hello) {
    console::ClientMessage message;
    *message.mutable_hello() = hello;
    return Send(message);
  }
  /// A ClientMessage in protobuf's text.
  std::vector<PageEvent> Send(const std::string& text) {
    console::ClientMessage message;
    REQUIRE(google::protobuf::TextFormat::ParseFromString(text, &message));
    return Send(message);
  }
  std::vector<PageEvent> Attend(const std::vector<std::string>& robots) {
    return Send(fmt::format("attend {{ robots: ['{}'] }}", conav::Join(robots, "', '")));
  }
  std::vector<PageEvent> Ping(double page_time, double round_trip = 0.0, bool active = false) {
    return Send(fmt::format("ping {{ page_time: {} measured_round_trip: {} active: {} }}",
                            page_time, round_trip, active));
  }

  /// Puts an update that is due at once.
  void PutDue(const std::string& key, const std::string& message) {
    updates.Put(key, Said(key, message));
    clock.Advance(std::chrono::seconds(1));
  }
  /// A page comes back on a new connection; its Welcome.
  console::Welcome Return(const console::Hello& hello) {
    Connect();
    Send(hello);
    return NextOne().welcome();
  }

  /// The next message; nothing when there is none now.
  std::optional<console::ServerMessage> Next() {
    const auto bytes = feed->Next(clock.Now());
    if (!bytes) return std::nullopt;
    console::ServerMessage message;
    REQUIRE(message.ParseFromString(*bytes));
    return message;
  }
  console::ServerMessage NextOne() {
    const auto message = Next();
    REQUIRE(message);
    return *message;
  }
  /// All messages that there are now.
  std::vector<console::ServerMessage> Drain() {
    std::vector<console::ServerMessage> messages;
    while (const auto message = Next()) messages.push_back(*message);
    return messages;
  }

  /// Says hello and takes what comes first: Welcome and all updates.
  console::Welcome Join(const console::Hello& hello = Hello()) {
    REQUIRE(Send(hello).size() == 1);
    const console::Welcome first = NextOne().welcome();
    Drain();
    return first;
  }

  void PutFrame(const std::string& robot, const std::string& jpeg = "jpeg") {
    console::Frame frame;
    frame.set_robot(robot);
    frame.set_jpeg(jpeg);
    frames.Put(std::move(frame));
  }

  void ExpectGoodbye(const std::string& part, bool retry) {
    const auto messages = Drain();
    REQUIRE_FALSE(messages.empty());
    REQUIRE(messages.back().has_goodbye());
    CHECK_THAT(messages.back().goodbye().reason(), Catch::Contains(part));
    CHECK(messages.back().goodbye().retry() == retry);
    CHECK(feed->finished());
    CHECK(feed->retry() == retry);
  }

  GatewayOptions options;
  UpdateLog updates;
  FrameSlots frames;
  console::Welcome welcome;
  AccessControl access{""};
  bool has_room = true;
  FakeClock clock;
  std::uint64_t connections = 0;
  std::optional<PageFeed> feed;
};

}  // namespace conav::operators
