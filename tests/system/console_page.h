#pragma once

#include <catch2/catch.hpp>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "common/runtime/clock.h"
#include "integration/operator/page_client.h"

namespace conav::operators {

/// A page of the console that keeps what its service last said. Each step fails the test when the
/// service does not answer.
class ConsolePage {
 public:
  explicit ConsolePage(int port) : client_({.port = port}) {
    REQUIRE(client_.refused() == 0);
    console::ClientMessage message;
    message.mutable_hello()->set_instance(std::string(16, 'p'));
    Send(message);
  }

  void Send(const console::ClientMessage& message) { REQUIRE(client_.Send(message)); }
  /// Sends a request for world w1 that `fill` completes; returns its reply.
  console::Reply Ask(const std::function<void(console::Request&)>& fill) {
    console::ClientMessage message;
    console::Request& request = *message.mutable_request();
    request.set_id(++id_);
    request.set_world("w1");
    request.set_valid_until(welcome.service_time() + 1000.0);
    fill(request);
    Send(message);
    ReadUntil([&] { return reply_.id() == id_; });
    return reply_;
  }
  void ReadUntil(const std::function<bool()>& condition) {
    while (!condition()) Read();
  }
  void Read() {
    const auto message = client_.Receive();
    REQUIRE(message);
    if (message->has_welcome()) welcome = message->welcome();
    if (message->has_reply()) reply_ = message->reply();
    if (message->updates().everything()) {
      belief.Clear();
      robot.Clear();
      snapshots.clear();
      events = 0;
    }
    for (const console::Update& update : message->updates().update()) {
      kinds.insert(update.body_case());
      if (update.has_task()) task = update.task();
      if (update.has_playback()) playback = update.playback();
      if (update.has_belief()) belief = update.belief();
      if (update.has_robot()) robot = update.robot();
      if (update.has_truth()) truth = update.truth();
      if (update.has_snapshot()) snapshots[update.snapshot().sequence_number()] = update.snapshot();
      if (update.has_event()) ++events;
    }
  }

  console::Welcome welcome;
  console::Task task;
  console::Playback playback;
  console::Belief belief;
  console::Robot robot;
  console::Truth truth;
  std::map<std::uint64_t, console::Snapshot> snapshots;
  std::size_t events = 0;
  std::set<int> kinds;  // which kinds of updates

 private:
  PageClient client_;
  console::Reply reply_;
  /// Above those of earlier pages, which the service remembers.
  std::uint64_t id_ = static_cast<std::uint64_t>(WallSeconds() * 1e6);
};

}  // namespace conav::operators
