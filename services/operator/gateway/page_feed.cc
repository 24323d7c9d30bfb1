#include "operator/gateway/page_feed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/protocol/entity_name.h"
#include "common/runtime/utf8.h"
#include "operator/console/wire.h"
#include "operator/gateway/access.h"

namespace conav::operators {
namespace {

constexpr std::size_t kNameLimit = 40;
constexpr std::size_t kInstanceShortest = 16;
constexpr std::size_t kInstanceLongest = 64;

bool IsInstance(std::string_view text) {
  return text.size() >= kInstanceShortest && text.size() <= kInstanceLongest &&
         text.find_first_not_of("0123456789abcdefghijklmnopqrstuvwxyz-") == std::string_view::npos;
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

PageFeed::PageFeed(const PageContext& context, std::uint64_t page, Clock::TimePoint now)
    : context_(context),
      page_(page),
      connected_at_(now),
      rate_(context.options.message_rate, context.options.message_burst, now),
      due_(now + kHelloLimit) {}

std::vector<PageEvent> PageFeed::Take(std::string_view bytes, Clock::TimePoint now, double wall_s) {
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
    Close(has_joined() ? "a second Hello" : "the first message is no Hello", false);
    return {};
  }
  switch (message->body_case()) {
    case console::ClientMessage::kHello:
      Greet(message->hello(), wall_s);
      if (!has_joined()) return {};
      return {{page_, *identity_, PageJoined{}}};
    case console::ClientMessage::kPing: {
      const double measured = message->ping().measured_round_trip();
      round_trip_s_ = std::isfinite(measured) ? std::max(0.0, measured) : 0.0;
      console::ServerMessage answer;
      answer.mutable_pong()->set_page_time(message->ping().page_time());
      answer.mutable_pong()->set_service_time(wall_s);
      Queue(answer);
      return {};
    }
    case console::ClientMessage::kAttend:
      wants_frames_ = message->attend().frames();
      frames_of_ = message->attend().robot();
      SeeNewestFrames();
      return {};
    case console::ClientMessage::kRequest:
      return {{page_, *identity_, PageAsked{message->request(), round_trip_s_}}};
    case console::ClientMessage::kSeek:
      return {{page_, *identity_, message->seek()}};
    case console::ClientMessage::BODY_NOT_SET:
      break;
  }
  return {};
}

std::optional<PageIdentity> PageFeed::Identify(const console::Hello& hello) {
  const auto role = RoleOf(context_.options.tokens, hello.token());
  if (!role) {
    Close(hello.token().empty() ? "a token is asked for: open the address that the service printed"
                                : "the token is not known",
          false);
    return std::nullopt;
  }
  if (!IsInstance(hello.instance())) {
    Close(fmt::format("instance of {} characters is not 16 to 64 of [0-9a-z-]",
                      hello.instance().size()),
          false);
    return std::nullopt;
  }
  if (hello.name().size() > kNameLimit * 4 ||
      (!hello.name().empty() && !IsPlainName(hello.name()))) {
    Close("the name is too long or has control characters", false);
    return std::nullopt;
  }
  const std::string part = ClientPart(hello.name()).substr(0, kNameLimit);
  return PageIdentity{part + "/" + hello.instance(), hello.name(), *role};
}

void PageFeed::Greet(const console::Hello& hello, double wall_s) {
  identity_ = Identify(hello);
  if (!identity_) return;
  generation_ = context_.updates.generation();
  const std::string run = RunOf(context_.welcome, generation_);
  everything_ = hello.run() != run || hello.sequence() > context_.updates.sequence();
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
  if (queue_.size() >= kQueueLimit) return Close("the page takes no answers any more", true);
  queue_.push_back(Encode(message));
}

void PageFeed::Close(std::string reason, bool retry) {
  if (closing_) return;
  closing_ = true;
  close_reason_ = std::move(reason);
  console::ServerMessage message;
  message.mutable_goodbye()->set_reason(close_reason_);
  message.mutable_goodbye()->set_retry(retry);
  queue_.push_back(Encode(message));
}

std::optional<std::string> PageFeed::Next(Clock::TimePoint now) {
  due_.reset();
  if (!has_joined() && !closing_) {
    due_ = connected_at_ + kHelloLimit;
    if (now >= *due_) Close("no Hello came", true);
  }
  if (!queue_.empty()) {
    std::string message = std::move(queue_.front());
    queue_.pop_front();
    return message;
  }
  if (closing_ || !has_joined()) return std::nullopt;
  if (auto updates = NextUpdates(now)) return updates;
  return NextFrame();
}

std::optional<std::string> PageFeed::NextUpdates(Clock::TimePoint now) {
  const auto period = Seconds(1.0 / context_.options.update_rate_hz);
  if (updated_at_ && now < *updated_at_ + period) {
    due_ = *updated_at_ + period;
    return std::nullopt;
  }
  const auto batch = context_.updates.After(generation_, sequence_, kBatchBytes);
  if (batch.generation != generation_) {  // the world has begun anew
    Close("the run begins anew", true);
    return Next(now);
  }
  if (batch.updates.empty()) return std::nullopt;
  sequence_ = batch.sequence;
  if (!batch.more) updated_at_ = now;
  return EncodeUpdates(batch.updates, std::exchange(everything_, false));
}

void PageFeed::SeeNewestFrames() {
  frames_seen_ = context_.frames.Numbers();
  for (auto& [robot, number] : frames_seen_) number -= 1;
}

std::optional<std::string> PageFeed::NextFrame() {
  if (!wants_frames_) return std::nullopt;
  for (const auto& [robot, slot] : context_.frames.Newer(frames_seen_)) {
    const std::uint64_t skipped = slot.number - frames_seen_[robot] - 1;
    frames_seen_[robot] = slot.number;
    if (!frames_of_.empty() && frames_of_ != robot) continue;
    skipped_[robot] += skipped;
    frames_skipped_ += skipped;
    console::ServerMessage message;
    *message.mutable_frame() = *slot.frame;
    message.mutable_frame()->set_skipped(skipped_[robot]);
    return Encode(message);
  }
  return std::nullopt;
}

}  // namespace conav::operators
