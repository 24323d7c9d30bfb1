#pragma once

#include <google/protobuf/text_format.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "integration/operator/hand_made_sim.h"
#include "integration/operator/page_client.h"

namespace conav::operators {

/// What one loaded page of the console knows and asks, over all its connections.
class Page {
 public:
  /// `step` is called again and again while the page waits.
  Page(char instance, std::function<void()> step) : instance_(instance), step_(std::move(step)) {}

  void Connect(int port, const std::string& token = "", bool experimenter = false) {
    client_.emplace(PageOptions{.port = port});
    REQUIRE(client_->refused() == 0);
    console::ClientMessage message;
    message.mutable_hello()->set_token(token);
    message.mutable_hello()->set_experimenter(experimenter);
    message.mutable_hello()->set_instance(std::string(16, instance_));
    message.mutable_hello()->set_run(welcome.run());
    message.mutable_hello()->set_sequence(sequence_);
    REQUIRE(client_->Send(message));
    last_.Clear();
    ReadUntil([this] { return last_.has_welcome(); });
    welcome = last_.welcome();
    if (!welcome.resumed()) Forget();
  }
  void Disconnect() { client_.reset(); }

  /// The reply to a request ("stop { robots: 'r1' }", protobuf's text) with the next id, or with that
  /// of the request before. `valid_s`: for how long, counted from the connection.
  console::Reply Ask(const std::string& text, bool again = false, double valid_s = 1000.0) {
    Send(text, again, valid_s);
    return WaitForReply();
  }
  void Send(const std::string& text, bool again = false, double valid_s = 1000.0) {
    console::ClientMessage message;
    console::Request& request = *message.mutable_request();
    REQUIRE(google::protobuf::TextFormat::ParseFromString(text, &request));
    request.set_id(again ? id_ : ++id_);
    request.set_world("w1");
    request.set_valid_until(welcome.service_time() + valid_s);
    REQUIRE(client_->Send(message));
  }
  /// To the newest request, or to the one with that id.
  console::Reply WaitForReply(std::uint64_t id = 0) {
    if (id == 0) id = id_;
    ReadUntil([&] { return replies_.contains(id); });
    const console::Reply reply = replies_.at(id);
    replies_.erase(id);
    return reply;
  }

  /// Says that somebody uses the page, until the gateway has received it.
  void Use() {
    console::ClientMessage message;
    message.mutable_ping()->set_active(true);
    REQUIRE(client_->Send(message));
    ReadUntil([this] { return last_.has_pong(); });
  }

  /// Shows the search reports of that robot only, and no camera.
  void ShowSearches(const std::string& robot) {
    console::ClientMessage message;
    if (!robot.empty()) message.mutable_attend()->add_searches(robot);
    message.mutable_attend();
    REQUIRE(client_->Send(message));
  }

  /// Says where it shows what, until the gateway has received it.
  void SendLayout(double width) {
    console::ClientMessage message;
    message.mutable_layout()->set_width(width);
    message.mutable_layout()->set_height(600.0);
    message.mutable_layout()->set_pixel_ratio(1.0);
    REQUIRE(client_->Send(message));
    Use();
  }

  template <class Condition>
  void ReadUntil(const Condition& condition) {
    while (!condition()) Read();
  }
  /// Reads until the belief has that revision.
  void ReadBelief(std::uint64_t revision) {
    ReadUntil([&] { return Has("belief") && at("belief").belief().revision() == revision; });
  }

  bool Has(const std::string& key) const { return known_.contains(key); }
  const console::Update& at(const std::string& key) const { return known_.at(key); }
  /// Lines of the command log, oldest first.
  const std::vector<console::Event>& events() const { return events_; }
  const std::map<std::uint64_t, console::Alert>& alerts() const { return alerts_; }
  std::uint64_t newest_id() const { return id_; }

  console::Welcome welcome;

 private:
  void Read() {
    const auto message = Receive();
    REQUIRE(message);
    last_ = *message;
    if (last_.has_reply()) replies_[last_.reply().id()] = last_.reply();
    if (last_.updates().everything()) Forget();
    for (const console::Update& update : last_.updates().update()) {
      sequence_ = update.sequence();
      known_[NameOf(update)] = update;
      if (update.has_event()) events_.push_back(update.event());
      if (update.has_alert()) alerts_[update.alert().id()] = update.alert();
    }
  }

  std::optional<console::ServerMessage> Receive() {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < deadline) {
      step_();
      if (auto message = client_->Receive(std::chrono::milliseconds(2))) return message;
    }
    return std::nullopt;
  }

  void Forget() {
    known_.clear();
    events_.clear();
    alerts_.clear();
  }

  static std::string NameOf(const console::Update& update) {
    return update.GetDescriptor()->FindFieldByNumber(update.body_case())->name();
  }

  char instance_;
  std::function<void()> step_;
  std::optional<PageClient> client_;
  console::ServerMessage last_;
  std::map<std::string, console::Update> known_;  // newest of each kind
  std::vector<console::Event> events_;
  std::map<std::uint64_t, console::Alert> alerts_;
  std::map<std::uint64_t, console::Reply> replies_;
  std::uint64_t sequence_ = 0;
  std::uint64_t id_ = 0;
};

/// The real service with its console and a clock that stands still, stepped while a page waits.
struct SteppedBench {
  SteppedBench() {
    std::ofstream(folder / "index.html") << "<page>";
    config.console.port = 0;
    config.console.web = folder.path().string();
  }
  int Start() {
    service.reset();
    participant.emplace("operator", bus);
    service.emplace(*participant, config, clock);
    const std::string url = service->console_url();
    return std::stoi(url.substr(url.rfind(':') + 1));
  }
  Page MakePage(char instance) {
    return Page(instance, [this] { service->Step(); });
  }

  TemporaryFolder folder;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  HandMadeSim sim{bus};
  OperatorConfig config = ConfigFor(folder / "operator.db");
  FakeClock clock;
  std::optional<bus::Participant> participant;
  std::optional<OperatorService> service;
};

}  // namespace conav::operators
