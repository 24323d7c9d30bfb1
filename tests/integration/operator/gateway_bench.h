#pragma once

#include <fmt/core.h>
#include <google/protobuf/text_format.h>

#include <catch2/catch.hpp>
#include <condition_variable>
#include <fstream>
#include <memory>
#include <mutex>

#include "common/runtime/clock.h"
#include "integration/operator/page_client.h"
#include "operator/gateway/gateway.h"
#include "support/temporary_folder.h"
#include "unit/operator/support/updates.h"

namespace conav::operators {

/// A page's message from protobuf's text.
inline console::ClientMessage MessageOf(const std::string& text) {
  console::ClientMessage message;
  REQUIRE(google::protobuf::TextFormat::ParseFromString(text, &message));
  return message;
}

/// A console::Hello of one of several pages.
inline console::ClientMessage HelloOf(char page = 'a') {
  return MessageOf(fmt::format("hello {{ name: 'anna' instance: '{}' }}", std::string(16, page)));
}

/// A real gateway on a port that is free, and what it shows.
struct GatewayBench {
  GatewayBench() {
    std::ofstream(folder / "index.html") << "<page>";
    options.web = folder.path().string();
    options.port = 0;
    welcome.set_run("run");
    updates.Put("a", Said("a", "1"));
  }

  Gateway& Start() {
    gateway = std::make_unique<Gateway>(options, Gateway::Shared{updates, frames, snapshots},
                                        welcome, [this] {
                                          const std::lock_guard lock(mutex);
                                          woken = true;
                                          wake.notify_all();
                                        });
    return *gateway;
  }

  PageOptions Page() const { return {.port = gateway->port()}; }

  /// How many there are, by the gateway's own count.
  double Pages() const { return MetricOf(gateway->port(), "conav_console_pages").value(); }

  /// The next thing that a page does.
  PageEvent NextEvent() {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (events.empty() && std::chrono::steady_clock::now() < deadline) TakeEvents();
    REQUIRE_FALSE(events.empty());
    PageEvent event = events.front();
    events.erase(events.begin());
    return event;
  }

  /// Waits for them a little.
  void TakeEvents() {
    std::unique_lock lock(mutex);
    wake.wait_for(lock, std::chrono::milliseconds(50), [this] { return woken; });
    woken = false;
    lock.unlock();
    for (PageEvent& event : gateway->Take()) events.push_back(std::move(event));
  }

  void PutUpdate(const std::string& key, const std::string& message) {
    updates.Put(key, Said(key, message));
    gateway->Notify();
  }

  test::TemporaryFolder folder;
  GatewayOptions options;
  UpdateLog updates;
  FrameSlots frames;
  SnapshotStore snapshots{1U << 20U};
  console::Welcome welcome;
  std::vector<PageEvent> events;
  std::mutex mutex;  // guards woken
  std::condition_variable wake;
  bool woken = false;
  std::unique_ptr<Gateway> gateway;
};

/// A page that has said hello, and what it knows.
struct KnowingPage {
  explicit KnowingPage(const PageOptions& options, const console::ClientMessage& hello = HelloOf())
      : client(options) {
    REQUIRE(client.refused() == 0);
    REQUIRE(client.Send(hello));
    const auto message = client.Receive();
    REQUIRE(message);
    REQUIRE(message->has_welcome());
    welcome = message->welcome();
  }

  /// False when nothing comes.
  bool Read(std::chrono::milliseconds limit = std::chrono::seconds(10)) {
    const auto message = client.Receive(limit);
    if (!message) return false;
    last = *message;
    if (last.updates().everything()) known.clear();
    for (const console::Update& update : last.updates().update()) {
      if (update.sequence() <= sequence) ++repeated;
      sequence = update.sequence();
      if (update.has_service()) known[update.service().name()] = update.service().message();
    }
    if (last.has_frame()) ++frames;
    return true;
  }

  /// Reads until `condition` holds.
  template <class Condition>
  void ReadUntil(const Condition& condition) {
    while (!condition()) REQUIRE(Read());
  }
  void ReadUpTo(std::uint64_t number) {
    ReadUntil([&] { return sequence >= number; });
  }

  PageClient client;
  console::Welcome welcome;
  console::ServerMessage last;
  std::map<std::string, std::string> known;
  std::uint64_t sequence = 0;
  int repeated = 0;
  int frames = 0;
};

}  // namespace conav::operators
