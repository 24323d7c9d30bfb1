#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>

#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "operator/gateway/gateway.h"
#include "operator/gateway/page_presence.h"
#include "operator/timeline/replay_player.h"

namespace conav::operators {

/// Shows a timeline on the console's page: all pages see the same place of it, and each may go to
/// another one. It begins to play when the first page comes. What pages ask otherwise is refused.
/// Threads: one; Run() or repeated Step().
class ReplayServer {
 public:
  /// `timeline` and `clock` outlive it. Throws StartupError as Gateway does.
  ReplayServer(const Timeline& timeline, const GatewayOptions& options, const Clock& clock);

  /// Blocks until `stop`.
  void Run(const StopToken& stop);
  void Step();
  std::string url() const { return gateway_->url(); }

 private:
  void Wait();
  void Take(const PageEvent& event);

  const Clock& clock_;
  UpdateLog updates_;
  FrameSlots frames_;
  PictureShelf pictures_;
  ReplayPlayer player_;
  Clock::TimePoint stepped_at_;
  /// Of the seeks that came since the last step: only where they end counts.
  std::optional<double> position_s_;
  std::optional<double> speed_;
  bool was_seen_ = false;
  PagePresence presence_;
  std::mutex mutex_;  // guards woken_
  std::condition_variable wake_;
  bool woken_ = false;
  std::optional<Gateway> gateway_;
};

}  // namespace conav::operators
