#include "operator/gateway/page_feed.h"

#include <fmt/core.h>

#include <cmath>

#include "common/msg/robot.h"
#include "common/runtime/text.h"
#include "operator/console/console_messages.h"

namespace conav::operators {

std::string CheckNow(const PageIdentity& who, const PageAsked& asked, double wall_s,
                     double drive_limit_s) {
  const console::Request& request = asked.request;
  const bool leads = request.has_pause() || request.has_abort();
  const bool is_for_all = request.has_stop() || request.has_note();
  const bool is_experimenter = who.role == console::ROLE_EXPERIMENTER;
  if (leads && !is_experimenter) return "only an experimenter may pause and abort";
  if (is_experimenter && !leads && !is_for_all) {
    return "an experimenter may watch, write notes, stop robots, pause and abort";
  }
  if (who.role == console::ROLE_OBSERVER && !is_for_all) {
    return "an observer may only watch, write notes and stop robots";
  }
  const double late = wall_s - request.valid_until();
  if (!(late <= 0.0)) return fmt::format("it arrived {:.1f} s too late", late);
  const bool drives = request.has_drive() && request.drive().action() != console::DRIVE_STOP;
  if (drives && asked.round_trip_s > drive_limit_s) {
    return fmt::format("the round trip takes {:.1f} s, longer than {:.1f} s: too long to drive",
                       asked.round_trip_s, drive_limit_s);
  }
  return "";
}

void PagePresence::Join(std::uint64_t page, const PageIdentity& who) {
  people_[page] = {who.client, who.name, who.role};
  left_at_.erase(who.client);
}

void PagePresence::Leave(std::uint64_t page, Clock::TimePoint now) {
  const auto found = people_.find(page);
  if (found == people_.end()) return;
  const std::string client = found->second.client;
  people_.erase(found);
  const bool is_here = std::any_of(people_.begin(), people_.end(), [&](const auto& entry) {
    return entry.second.client == client;
  });
  if (!is_here) left_at_[client] = now;
}

std::vector<std::string> PagePresence::TakeGone(Clock::TimePoint now) {
  std::vector<std::string> gone;
  for (const auto& [client, at] : left_at_) {
    if (now - at >= kGoneAfter) gone.push_back(client);
  }
  for (const std::string& client : gone) left_at_.erase(client);
  return gone;
}

std::vector<Person> PagePresence::People() const {
  std::map<std::string, Person> by_client;
  for (const auto& [page, person] : people_) by_client[person.client] = person;
  std::vector<Person> people;
  for (const auto& [client, person] : by_client) people.push_back(person);
  return people;
}

bool PagePresence::HasOperator() const {
  return std::ranges::any_of(people_, [](const auto& entry) {
    const console::Role role = entry.second.role;
    return role == console::ROLE_OPERATOR || role == console::ROLE_ADMIN;
  });
}

std::string PagePresence::NameOf(const std::string& client) const {
  for (const auto& [page, person] : people_) {
    if (person.client == client) return person.name;
  }
  return "";
}

namespace {

constexpr std::size_t kNameLimit = 40;
constexpr std::size_t kInstanceShortest = 16;
constexpr std::size_t kInstanceLongest = 64;
constexpr std::size_t kClientDigits = 16;

bool IsInstance(std::string_view text) {
  return text.size() >= kInstanceShortest && text.size() <= kInstanceLongest &&
         text.find_first_not_of("0123456789abcdefghijklmnopqrstuvwxyz-") == std::string_view::npos;
}

/// The number of characters in UTF-8.
std::size_t Characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

/// A name as part of a client's: what is not of its alphabet becomes "_".
std::string ClientPart(const std::string& name) {
  std::string part = name.empty() ? "console" : name;
  std::ranges::replace_if(
      part, [](char c) { return !IsNameCharacter(c); }, '_');
  return part;
}

std::string RunOf(const console::Welcome& welcome, std::uint64_t generation) {
  return fmt::format("{}.{}", welcome.run(), generation);
}

}  // namespace

PageFeed::PageFeed(const PageContext& context, std::uint64_t page, Clock::TimePoint now,
                   std::string address)
    : context_(context),
      page_(page),
      address_(std::move(address)),
      connected_at_(now),
      rate_(context.options.message_rate, context.options.message_burst, now),
      due_(now + kHelloLimit) {}

void PageFeed::CheckStay(Clock::TimePoint now) {
  if (has_joined() && !context_.access.MayStay(admission_, now)) {
    Close("the token was revoked, or has ended", false);
  }
}

std::vector<PageEvent> PageFeed::Take(std::string_view bytes, Clock::TimePoint now, double wall_s) {
  CheckStay(now);
  if (closing_) return {};
  if (!rate_.Allow(now)) {
    Close("too many messages", true);
    return {};
  }
  auto message = DecodeClientMessage(bytes);
  if (!message) {
    Close(message.error().text, false);
    return {};
  }
  if (message->has_hello() == has_joined()) {
    Close(has_joined() ? "a second Hello" : "the first message is not a Hello", false);
    return {};
  }
  switch (message->body_case()) {
    case console::ClientMessage::kHello:
      Welcome(message->hello(), now, wall_s);
      if (!has_joined()) return {};
      return {{page_, *identity_, PageJoined{}}};
    case console::ClientMessage::kPing: {
      const double measured = message->ping().measured_round_trip();
      round_trip_s_ = std::isfinite(measured) ? std::max(0.0, measured) : 0.0;
      console::ServerMessage answer;
      answer.mutable_pong()->set_page_time(message->ping().page_time());
      answer.mutable_pong()->set_service_time(wall_s);
      Queue(answer);
      if (!message->ping().active()) return {};
      return {{page_, *identity_, PageUsed{}}};
    }
    case console::ClientMessage::kAttend:
      frames_of_ = {message->attend().robots().begin(), message->attend().robots().end()};
      SeeNewestFrames();
      return {{page_, *identity_,
               PageAttends{
                   frames_of_,
                   {message->attend().searches().begin(), message->attend().searches().end()}}}};
    case console::ClientMessage::kTaken:
      NoteTaken(message->taken().messages());
      return {};
    case console::ClientMessage::kRequest:
      return {{page_, *identity_, PageAsked{message->request(), round_trip_s_}}};
    case console::ClientMessage::kSeek:
      return {{page_, *identity_, message->seek()}};
    case console::ClientMessage::kLayout:
      return {{page_, *identity_, message->layout()}};
    case console::ClientMessage::BODY_NOT_SET:
      break;
  }
  return {};
}

std::optional<PageIdentity> PageFeed::Identify(const console::Hello& hello, Clock::TimePoint now) {
  const auto admitted = context_.access.Admit(hello.token(), address_, now);
  if (!admitted) {
    Close(admitted.error().text, admitted.error().code == ErrorCode::kUnavailable);
    return std::nullopt;
  }
  admission_ = *admitted;
  if (!IsInstance(hello.instance())) {
    Close(fmt::format("instance of {} characters is not 16 to 64 of [0-9a-z-]",
                      hello.instance().size()),
          false);
    return std::nullopt;
  }
  if (std::string why = CheckRole(hello); !why.empty()) {
    Close(std::move(why), false);
    return std::nullopt;
  }
  const std::string& name = admission_.name.empty() ? hello.name() : admission_.name;
  if (!name.empty() && (Characters(name) > kNameLimit || !IsPlainName(name))) {
    Close(fmt::format("the name has a slash, control characters, or more than {} characters",
                      kNameLimit),
          false);
    return std::nullopt;
  }
  const std::string part = ClientPart(name).substr(0, kNameLimit);
  // Everybody sees a page's client name; knowing it must not be enough to act for it.
  const std::string secret = hello.token() + "\n" + hello.instance();
  return PageIdentity{part + "/" + Sha256Hex(secret).substr(0, kClientDigits), name,
                      hello.experimenter() ? console::ROLE_EXPERIMENTER : admission_.role};
}

std::string PageFeed::CheckRole(const console::Hello& hello) const {
  if (!hello.experimenter()) return "";
  if (!context_.welcome.experimenter()) return "no experimenter leads this task";
  const bool needs_none = admission_.sha256.empty();  // only this machine can reach the service
  return needs_none || admission_.role == console::ROLE_ADMIN
             ? ""
             : "the experimenter's page requires the token of an admin";
}

void PageFeed::Welcome(const console::Hello& hello, Clock::TimePoint now, double wall_s) {
  const auto identity = Identify(hello, now);
  if (!identity) return;
  if (!context_.has_room()) {
    return Close(fmt::format("{} pages are open, the limit of operator.console.max_pages",
                             context_.options.max_pages),
                 true);
  }
  identity_ = identity;
  says_taken_ = hello.says_taken();
  generation_ = context_.updates.generation();
  const std::string run = RunOf(context_.welcome, generation_);
  everything_ =
      hello.run() != run || hello.sequence() == 0 || hello.sequence() > context_.updates.sequence();
  sequence_ = everything_ ? 0 : hello.sequence();
  console::ServerMessage message;
  *message.mutable_welcome() = context_.welcome;
  message.mutable_welcome()->set_run(run);
  message.mutable_welcome()->set_resumed(!everything_);
  message.mutable_welcome()->set_role(identity_->role);
  message.mutable_welcome()->set_client(identity_->client);
  message.mutable_welcome()->set_service_time(wall_s);
  Queue(message);
}

void PageFeed::Add(const console::Reply& reply) {
  if (closing_) return;
  console::ServerMessage message;
  *message.mutable_reply() = reply;
  Queue(message);
}

void PageFeed::Queue(const console::ServerMessage& message) {
  if (queue_.size() >= kQueueLimit) return Close("the page does not read its replies", true);
  queue_.push_back(Encode(message));
}

void PageFeed::Close(std::string reason, bool retry) {
  if (closing_) return;
  fault_ = reason;
  SayGoodbye(std::move(reason), retry);
}

void PageFeed::End(std::string reason) {
  if (!closing_) SayGoodbye(std::move(reason), true);
}

void PageFeed::SayGoodbye(std::string reason, bool retry) {
  closing_ = true;
  retry_ = retry;
  console::ServerMessage message;
  message.mutable_goodbye()->set_reason(std::move(reason));
  message.mutable_goodbye()->set_retry(retry);
  queue_.push_back(Encode(message));
}

std::optional<std::string> PageFeed::Next(Clock::TimePoint now) {
  due_.reset();
  CheckStay(now);
  if (!has_joined() && !closing_) {
    due_ = connected_at_ + kHelloLimit;
    if (now >= *due_) Close("no Hello arrived", true);
  }
  if (!queue_.empty()) {
    std::string message = std::move(queue_.front());
    queue_.pop_front();
    return message;
  }
  if (closing_ || !has_joined()) return std::nullopt;
  if (says_taken_ && sent_ - taken_ >= kUntakenLimit) return std::nullopt;
  auto state = NextState(now);
  if (state && !closing_) ++sent_;
  return state;
}

std::optional<std::string> PageFeed::NextState(Clock::TimePoint now) {
  // In turn: a page that takes fewer messages than there are updates still sees its streams move.
  if (std::exchange(frame_is_next_, false)) {
    if (auto frame = NextFrame()) return frame;
  }
  if (auto updates = NextUpdates(now)) {
    frame_is_next_ = !closing_;
    return updates;
  }
  return NextFrame();
}

void PageFeed::NoteTaken(std::uint64_t messages) {
  if (messages <= taken_ || messages > sent_) return;
  taken_ = messages;
  rate_.GiveBack();  // at most one for each message that it was sent
}

std::optional<std::string> PageFeed::NextUpdates(Clock::TimePoint now) {
  const auto period = Seconds(1.0 / context_.options.update_rate_hz);
  if (updated_at_ && now < *updated_at_ + period) {
    due_ = *updated_at_ + period;
    return std::nullopt;
  }
  const auto reader = identity_->role == console::ROLE_EXPERIMENTER
                          ? UpdateLog::Reader::kExperimenter
                          : UpdateLog::Reader::kAnyone;
  const auto batch = context_.updates.After(generation_, sequence_, kBatchBytes, reader);
  if (batch.generation != generation_) {  // a new run of a world
    if (context_.welcome.mode() != console::MODE_REPLAY) {
      End("a new run began");
      return Next(now);
    }
    generation_ = batch.generation;  // nothing of the page's own is lost: it goes on at once
    everything_ = true;
  }
  if (batch.updates.empty()) return std::nullopt;
  sequence_ = batch.sequence;
  if (!batch.more) updated_at_ = now;
  return EncodeUpdates(batch.updates, std::exchange(everything_, false));
}

void PageFeed::SeeNewestFrames() {
  for (const auto& [robot, number] : context_.frames.Numbers()) {
    std::uint64_t& seen = frames_seen_[robot];
    seen = std::max(seen, number - 1);
  }
}

std::optional<FrameSlots::Slot> PageFeed::NewestFrame() const {
  auto newer = context_.frames.Newer(frames_seen_);
  std::erase_if(newer, [&](const auto& slot) { return !frames_of_.contains(slot.first); });
  if (newer.empty()) return std::nullopt;
  // In turn, or a slow connection would only show the first robot.
  const auto next = newer.upper_bound(last_frame_of_);
  return next == newer.end() ? newer.begin()->second : next->second;
}

std::optional<std::string> PageFeed::NextFrame() {
  const auto slot = NewestFrame();
  if (!slot) return std::nullopt;
  const std::string& robot = slot->frame->robot();
  const std::uint64_t skipped = slot->number - frames_seen_[robot] - 1;
  frames_seen_[robot] = slot->number;
  skipped_[robot] += skipped;
  frames_skipped_ += skipped;
  last_frame_of_ = robot;
  console::ServerMessage message;
  *message.mutable_frame() = *slot->frame;
  message.mutable_frame()->set_skipped(skipped_[robot]);
  return Encode(message);
}

}  // namespace conav::operators
