#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/runtime/clock.h"
#include "operator/console/update_log.h"
#include "operator/gateway/frame_slots.h"
#include "operator/gateway/gateway_options.h"
#include "operator/gateway/page_event.h"
#include "operator/gateway/rate_limit.h"

namespace conav::operators {

/// What all pages share.
struct PageContext {
  const GatewayOptions& options;
  const UpdateLog& updates;
  const FrameSlots& frames;
  /// With mode, version and limits; `run` names this run of the service.
  const console::Welcome& welcome;
  /// Whether one more page may join.
  std::function<bool()> has_room;
};

/// One connected page, as far as it has nothing to do with sockets: takes what it sends, and says
/// what to send it next. A page that is slow costs its queue of replies (bounded) and the one
/// message that is under way; updates and frames wait in the log and the slots, for all pages
/// together. One that says what it has shown is sent no more than it can show, and so sees nothing
/// old: buffers on the way and in the browser would otherwise hold seconds of it.
///
/// Threads: one caller.
class PageFeed {
 public:
  /// How long a page may take until its Hello.
  static constexpr std::chrono::seconds kHelloLimit{5};
  static constexpr std::size_t kQueueLimit = 1000;  // replies that the page did not take
  /// Updates and frames that a page may have before it has shown them, if it tells (Taken).
  static constexpr std::uint64_t kUntakenLimit = 2;
  /// Of updates in one message: more than a slow page lets gather. What is told often stands behind
  /// all else in the log, and would never be reached in smaller pieces.
  static constexpr std::size_t kBatchBytes = 1024U * 1024U;

  PageFeed(const PageContext& context, std::uint64_t page, Clock::TimePoint now);

  /// `wall_s`: s since 1970, for the page's clock.
  std::vector<PageEvent> Take(std::string_view bytes, Clock::TimePoint now, double wall_s);
  /// To a request of this page.
  void Add(const console::Reply& reply);
  /// Ends the connection after what is queued, for what the page did or takes part in.
  void Close(std::string reason, bool retry);
  /// The same, and the page has no part in it: it shall come back.
  void End(std::string reason);

  /// The next message to send, if there is one now: answers first, then updates and frames in turn.
  std::optional<std::string> Next(Clock::TimePoint now);
  /// When Next() may have something although nothing new comes.
  std::optional<Clock::TimePoint> due() const { return due_; }
  /// True when everything was said and the connection shall end.
  bool finished() const { return closing_ && queue_.empty(); }
  /// What the page was closed for; empty when it is as it should be.
  const std::string& fault() const { return fault_; }
  /// Whether it was told to come back.
  bool retry() const { return retry_; }
  std::uint64_t page() const { return page_; }
  const std::optional<PageIdentity>& identity() const { return identity_; }
  bool has_joined() const { return identity_.has_value(); }
  /// Neither joined nor sent away.
  bool is_stranger() const { return !has_joined() && !closing_; }
  /// Frames that this page was too slow for, since the call before.
  std::uint64_t TakeFramesSkipped() { return std::exchange(frames_skipped_, 0); }

 private:
  void Greet(const console::Hello& hello, double wall_s);
  std::optional<PageIdentity> Identify(const console::Hello& hello);
  void Queue(const console::ServerMessage& message);
  void SayGoodbye(std::string reason, bool retry);
  void NoteTaken(std::uint64_t messages);
  /// Updates or a frame, in turn.
  std::optional<std::string> NextState(Clock::TimePoint now);
  std::optional<std::string> NextUpdates(Clock::TimePoint now);
  /// Frames count as skipped from here on.
  void SeeNewestFrames();
  std::optional<FrameSlots::Slot> NewestFrame() const;
  std::optional<std::string> NextFrame();

  PageContext context_;
  std::uint64_t page_;
  Clock::TimePoint connected_at_;
  RateLimit rate_;
  std::optional<PageIdentity> identity_;
  std::deque<std::string> queue_;
  std::uint64_t generation_ = 0;
  std::uint64_t sequence_ = 0;
  bool everything_ = true;
  std::optional<Clock::TimePoint> updated_at_;
  std::optional<Clock::TimePoint> due_;
  std::map<std::string, std::uint64_t> frames_seen_;  // number, by robot
  std::map<std::string, std::uint64_t> skipped_;      // by robot
  std::uint64_t frames_skipped_ = 0;
  std::string last_frame_of_;  // robot
  bool frame_is_next_ = false;
  bool says_taken_ = false;
  std::uint64_t sent_ = 0;   // updates and frames
  std::uint64_t taken_ = 0;  // of these
  bool wants_frames_ = false;
  std::string frames_of_;  // robot; empty = all
  double round_trip_s_ = 0.0;
  bool closing_ = false;
  bool retry_ = false;
  std::string fault_;
};

}  // namespace conav::operators
