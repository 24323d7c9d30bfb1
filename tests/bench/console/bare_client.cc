#include "bench/console/bare_client.h"

#include <chrono>
#include <utility>

#include "bench/support/measure.h"
#include "common/runtime/clock.h"
#include "integration/operator/page_client.h"

namespace conav::bench {
namespace {

using operators::PageClient;

constexpr std::chrono::milliseconds kLookAround{50};
constexpr double kPingPeriodS = 0.5;  // as a page does

console::ClientMessage Hello() {
  console::ClientMessage message;
  message.mutable_hello()->set_name("Bare client");
  message.mutable_hello()->set_instance("bench-console-bare-client");
  return message;
}

console::ClientMessage Attend(const std::string& robot) {
  console::ClientMessage message;
  message.mutable_attend()->set_robot(robot);
  message.mutable_attend()->set_frames(true);
  return message;
}

console::ClientMessage Ping(double now_s) {
  console::ClientMessage message;
  message.mutable_ping()->set_page_time(now_s);
  return message;
}

}  // namespace

BareClient::BareClient(int port, const Drive& drive, const std::string& frames)
    : drive_(drive), thread_([this, port, frames] { Run(port, frames); }) {}

BareClient::~BareClient() {
  stop_ = true;
  thread_.join();
}

std::vector<double> BareClient::TakeAges() {
  const std::lock_guard lock(mutex_);
  return std::exchange(ages_ms_, {});
}

void BareClient::Run(int port, const std::string& frames) {
  operators::PageOptions options;
  options.port = port;
  PageClient client(options);
  client.Send(Hello());
  client.Send(Attend(frames));
  double pinged_s = 0.0;
  while (!stop_ && !client.ended()) {
    const auto message = client.Receive(kLookAround);
    const double now_s = WallSeconds();
    if (message) {
      const std::lock_guard lock(mutex_);
      for (const console::Update& update : message->updates().update()) {
        if (update.has_robot()) ages_ms_.push_back(1000.0 * drive_.AgeS(update.robot().x(), now_s));
      }
    }
    if (now_s - pinged_s >= kPingPeriodS) {
      pinged_s = now_s;
      client.Send(Ping(now_s));
    }
    cpu_s_ = ThreadSeconds();
  }
  ended_ = client.ended();
}

}  // namespace conav::bench
