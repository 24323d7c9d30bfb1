#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/runtime/clock.h"
#include "console.pb.h"
#include "operator/console/console_state.h"
#include "operator/console/update_log.h"
#include "operator/gateway/access.h"
#include "operator/gateway/snapshot_store.h"

namespace conav::operators {

/// The person at a page, known from its Hello.
struct PageIdentity {
  std::string client;  // as in OperatorRequest::client: "<name>/<instance>"
  std::string name;    // the token's; without tokens as typed
  console::Role role = console::ROLE_OBSERVER;
};

struct PageJoined {};
struct PageLeft {};
/// The person used the page, with or without a request.
struct PageUsed {};
/// The page shows the cameras of these robots, and the search reports of those; no others.
struct PageAttends {
  std::set<std::string> robots;
  std::set<std::string> searches;
};
struct PageAsked {
  console::Request request;
  double round_trip_s = 0.0;  // as the page measured last; 0 = never
};

/// What a page did. `page` is one connection; a page that reconnects gets another number.
struct PageEvent {
  std::uint64_t page = 0;
  PageIdentity who;
  std::variant<PageJoined, PageLeft, PageUsed, PageAttends, PageAsked, console::Seek,
               console::PageLayout>
      body;
};

/// Why a page with this role and connection may not ask that now; empty = it may. `wall_s`: s
/// since 1970, as in `valid_until`. `drive_limit_s`: the longest round trip for driving.
std::string CheckNow(const PageIdentity& who, const PageAsked& asked, double wall_s,
                     double drive_limit_s);

/// The people at the console now. A client that reloads its page or briefly loses its connection
/// has two pages for a while; it has gone when it has had no page for kGoneAfter.
/// Pure; threads: not synchronised. `now`: wall time.
class PagePresence {
 public:
  /// A page that reconnects within this time keeps its client's control of robots.
  static constexpr std::chrono::seconds kGoneAfter{10};

  void Join(std::uint64_t page, const PageIdentity& who);
  void Leave(std::uint64_t page, Clock::TimePoint now);
  /// Clients without a page for kGoneAfter, each once.
  std::vector<std::string> TakeGone(Clock::TimePoint now);

  /// Each client once.
  std::vector<Person> People() const;
  /// Whether somebody who may command is here: in a study the participant.
  bool HasOperator() const;
  /// As typed; empty for one who is not here.
  std::string NameOf(const std::string& client) const;

 private:
  std::map<std::uint64_t, Person> people_;           // by page
  std::map<std::string, Clock::TimePoint> left_at_;  // by client without a page
};

/// What all pages share.
struct PageContext {
  const GatewayOptions& options;
  const UpdateLog& updates;
  const FrameSlots& frames;
  /// With mode, version and limits; `run` names this run of the service.
  const console::Welcome& welcome;
  AccessControl& access;
  /// Whether one more page may join.
  std::function<bool()> has_room;
};

/// One connected page without its socket: takes the messages that arrive and decides what to send
/// next. A slow page costs a bounded queue of replies and the one message under way; updates and
/// frames wait in the log and the slots, shared by all pages. A page that acknowledges what it has
/// shown (Taken) is sent only as much as it can show: buffers on the way would otherwise delay it
/// by seconds.
///
/// Threads: one caller.
class PageFeed {
 public:
  /// Time limit for a page's Hello.
  static constexpr std::chrono::seconds kHelloLimit{5};
  static constexpr std::size_t kQueueLimit = 1000;  // replies that the page did not take
  /// Updates and frames under way to a page that acknowledges them (Taken).
  static constexpr std::uint64_t kUntakenLimit = 2;
  /// Size of updates in one message: more than gathers for a slow page. Frequent updates stand at
  /// the end of the log, and would never be reached in smaller pieces.
  static constexpr std::size_t kBatchBytes = 1024U * 1024U;

  /// `address`: of the client.
  PageFeed(const PageContext& context, std::uint64_t page, Clock::TimePoint now,
           std::string address = "");

  /// `wall_s`: s since 1970, for the page's clock.
  std::vector<PageEvent> Take(std::string_view bytes, Clock::TimePoint now, double wall_s);
  /// To a request of this page.
  void Add(const console::Reply& reply);
  /// Closes the connection after the queued messages because of a fault of the page.
  void Close(std::string reason, bool retry);
  /// Closes it for another reason; the page reconnects.
  void End(std::string reason);

  /// The next message to send, if there is one now: answers first, then updates and frames in turn.
  std::optional<std::string> Next(Clock::TimePoint now);
  /// When Next() may return something without new input.
  std::optional<Clock::TimePoint> due() const { return due_; }
  /// True when everything was sent and the connection should close.
  bool finished() const { return closing_ && queue_.empty(); }
  /// The fault that closed the page; empty without one.
  const std::string& fault() const { return fault_; }
  /// Whether the page is asked to reconnect.
  bool retry() const { return retry_; }
  std::uint64_t page() const { return page_; }
  const std::optional<PageIdentity>& identity() const { return identity_; }
  bool has_joined() const { return identity_.has_value(); }
  /// Joined, and there is still something to send or to take.
  bool is_kept() const { return has_joined() && !closing_; }
  /// Neither joined nor closing.
  bool is_new() const { return !has_joined() && !closing_; }
  /// Frames that this page was too slow for, since the call before.
  std::uint64_t TakeFramesSkipped() { return std::exchange(frames_skipped_, 0); }

 private:
  void Welcome(const console::Hello& hello, Clock::TimePoint now, double wall_s);
  std::optional<PageIdentity> Identify(const console::Hello& hello, Clock::TimePoint now);
  /// Why an admitted page may not have the role that it wants; empty = it may.
  std::string CheckRole(const console::Hello& hello) const;
  /// Closes the page when its token no longer counts.
  void CheckStay(Clock::TimePoint now);
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
  std::string address_;
  AccessControl::Admission admission_;
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
  std::uint64_t sent_ = 0;           // updates and frames
  std::uint64_t taken_ = 0;          // of these
  std::set<std::string> frames_of_;  // robots
  double round_trip_s_ = 0.0;
  bool closing_ = false;
  bool retry_ = false;
  std::string fault_;
};

}  // namespace conav::operators
