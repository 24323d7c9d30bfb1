#include "operator/replay/replay_server.h"

#include <chrono>
#include <utility>

#include "operator/console/wall_seconds.h"

namespace conav::operators {
namespace {

constexpr std::chrono::milliseconds kPeriod{30};

console::Welcome MakeWelcome() {
  console::Welcome welcome;
  welcome.set_mode(console::MODE_REPLAY);
  return welcome;
}

}  // namespace

ReplayServer::ReplayServer(const Timeline& timeline, const GatewayOptions& options,
                           const Clock& clock)
    : clock_(clock),
      pictures_(options.pictures_bytes()),
      player_(timeline, {updates_, frames_, pictures_}, WallSeconds()),
      stepped_at_(clock.Now()) {
  gateway_.emplace(options, Gateway::Shared{updates_, frames_, pictures_}, MakeWelcome(), [this] {
    const std::lock_guard lock(mutex_);
    woken_ = true;
    wake_.notify_one();
  });
}

void ReplayServer::Run(const StopToken& stop) {
  while (!stop.stop_requested()) {
    Wait();
    Step();
  }
}

void ReplayServer::Wait() {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, kPeriod, [this] { return woken_; });
  woken_ = false;
}

void ReplayServer::Step() {
  const double elapsed_s =
      std::chrono::duration<double>(clock_.Now() - std::exchange(stepped_at_, clock_.Now()))
          .count();
  player_.Advance(elapsed_s, WallSeconds());
  for (const PageEvent& event : gateway_->Take()) Take(event);
  if (position_s_ || speed_) player_.Seek(position_s_, speed_, WallSeconds());
  position_s_.reset();
  speed_.reset();
  gateway_->SetReadiness({true, "{\"ready\":true,\"message\":\"a recording\"}\n"});
  gateway_->Notify();
}

void ReplayServer::Take(const PageEvent& event) {
  if (const auto* seek = std::get_if<console::Seek>(&event.body)) {
    if (seek->has_position()) position_s_ = seek->position();
    if (seek->has_speed()) speed_ = seek->speed();
  } else if (const auto* asked = std::get_if<PageAsked>(&event.body)) {
    console::Reply reply;
    reply.set_id(asked->request.id());
    reply.set_reason("this is a recording");
    gateway_->Send(event.page, reply);
  } else if (std::holds_alternative<PageJoined>(event.body)) {
    presence_.Join(event.page, event.who);
    if (!std::exchange(was_seen_, true)) speed_ = 1.0;
    player_.Hear(presence_.People());
  } else {
    presence_.Leave(event.page, clock_.Now());
    player_.Hear(presence_.People());
  }
}

}  // namespace conav::operators
