#include "operator/foxglove/client_feed.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/runtime/text.h"

namespace conav::foxglove {
namespace {

using console::ROLE_OBSERVER;

constexpr std::chrono::seconds kSkippedPeriod{1};
constexpr std::array<std::string_view, 2> kPoseSchemas{"geometry_msgs/msg/PoseStamped",
                                                       "geometry_msgs/PoseStamped"};

bool IsEncoding(std::string_view encoding) { return encoding == "cdr" || encoding == "json"; }

}  // namespace

ClientFeed::ClientFeed(const Catalog& catalog, FeedHost& host, std::uint64_t number,
                       console::Role role, const Limits& limits, Clock::TimePoint now)
    : catalog_(catalog),
      host_(host),
      number_(number),
      role_(role),
      limits_(limits),
      rate_(limits.message_rate, limits.message_burst, now) {
  std::vector<Channel> channels;
  for (const Catalog::Entry& entry : catalog_.channels) channels.push_back(entry.channel);
  for (std::string text : {ServerInfoText("conav", catalog_.session), AdvertiseText(channels),
                           AdvertiseServicesText(catalog_.services)}) {
    reply_bytes_ += text.size();
    replies_.push_back({std::move(text), nullptr, true});
  }
  reply_limit_ = reply_bytes_ + limits_.queue_bytes;
}

ClientFeed::~ClientFeed() {
  for (const auto& [channel, subscription] : subscription_of_) host_.Left(channel);
}

void ClientFeed::Take(std::string_view bytes, bool is_text, Clock::TimePoint now) {
  if (closing_) return;
  if (!rate_.Allow(now)) return Close("too many messages", true);
  const auto message = is_text ? ParseText(bytes) : ParseBinary(bytes);
  if (message) return std::visit([this](const auto& body) { Handle(body); }, *message);
  Complain(message.error().text);
  if (message.error().code == ErrorCode::kMalformed && ++faults_ >= kFaults) {
    Close(fmt::format("{} messages that cannot be read", faults_), false);
  }
}

std::optional<SocketMessage> ClientFeed::Next(Clock::TimePoint now) {
  due_.reset();
  if (!replies_.empty()) {
    SocketMessage reply = std::move(replies_.front());
    replies_.pop_front();
    reply_bytes_ -= reply.bytes.size();
    return reply;
  }
  if (closing_) return std::nullopt;
  if (auto time = NextTime(now)) return time;
  if (auto status = SkippedStatus(now)) return status;
  if (queue_.empty()) return std::nullopt;
  const Waiting& next = queue_.begin()->second;
  SocketMessage message{MessageHead(next.subscription, next.message.time_ns), next.message.payload,
                        false};
  Erase(queue_.begin()->first);
  return message;
}

std::optional<SocketMessage> ClientFeed::NextTime(Clock::TimePoint now) {
  if (time_ns_ == time_sent_ns_) return std::nullopt;
  const Clock::TimePoint at = time_sent_at_ + Seconds(1.0 / limits_.time_rate_hz);
  if (now < at) {
    due_ = at;
    return std::nullopt;
  }
  time_sent_at_ = now;
  time_sent_ns_ = time_ns_;
  return SocketMessage{TimeBytes(time_ns_), nullptr, false};
}

std::optional<SocketMessage> ClientFeed::SkippedStatus(Clock::TimePoint now) {
  if (skipped_ == 0 || now < skipped_told_at_ + kSkippedPeriod) return std::nullopt;
  skipped_told_at_ = now;
  const std::uint64_t skipped = std::exchange(skipped_, 0);
  host_.CountSkipped(number_, skipped);
  return SocketMessage{
      StatusText(StatusLevel::kWarning,
                 fmt::format("this connection is too slow: {} messages were skipped", skipped),
                 "skipped"),
      nullptr, true};
}

void ClientFeed::Add(std::string bytes, bool is_text) {
  if (closing_) return;
  if (replies_.size() >= kReplies || reply_bytes_ > reply_limit_) {
    replies_.clear();
    reply_bytes_ = 0;
    return Close("it takes no answers", true);
  }
  reply_bytes_ += bytes.size();
  replies_.push_back({std::move(bytes), nullptr, is_text});
}

void ClientFeed::Add(const ChannelMessage& message) {
  const auto found = subscription_of_.find(message.channel);
  if (found == subscription_of_.end() || closing_) return;
  Subscription& subscription = subscriptions_.at(found->second);
  const bool replaces = catalog_.channels[message.channel - 1].backlog == Backlog::kNewest;
  const std::size_t limit = replaces ? 1 : kQueueMessages;
  if (subscription.waiting.size() >= limit) {
    Erase(subscription.waiting.front());
    if (!replaces) ++skipped_;
  }
  queue_[++last_key_] = {found->second, message};
  subscription.waiting.push_back(last_key_);
  queued_bytes_ += message.payload->size();
  while (queued_bytes_ > limits_.queue_bytes && queue_.size() > 1) {
    Erase(queue_.begin()->first);
    ++skipped_;
  }
}

void ClientFeed::Erase(std::uint64_t key) {
  const auto found = queue_.find(key);
  queued_bytes_ -= found->second.message.payload->size();
  std::deque<std::uint64_t>& waiting = subscriptions_.at(found->second.subscription).waiting;
  std::erase(waiting, key);
  queue_.erase(found);
}

void ClientFeed::SendGraph(const std::shared_ptr<const std::string>& graph) {
  if (watches_graph_ && graph) Add(*graph, true);
}

void ClientFeed::Complain(const std::string& message) {
  Add(StatusText(StatusLevel::kError, message), true);
}

void ClientFeed::Close(std::string reason, bool retry) {
  if (closing_) return;
  Add(StatusText(StatusLevel::kError, reason), true);
  closing_ = true;
  retry_ = retry;
  fault_ = std::move(reason);
}

void ClientFeed::Handle(const Subscribe& message) {
  for (const auto& [id, channel] : message.subscriptions) {
    if (channel == 0 || channel > catalog_.channels.size()) {
      Complain(fmt::format("subscribe: there is no channel {}", channel));
    } else if (subscriptions_.contains(id)) {
      Complain(fmt::format("subscribe: subscription {} is in use", id));
    } else if (subscription_of_.contains(channel)) {
      Complain(fmt::format("subscribe: channel {} is subscribed already", channel));
    } else {
      subscriptions_[id].channel = channel;
      subscription_of_[channel] = id;
      for (const ChannelMessage& kept : host_.Join(channel)) Add(kept);
    }
    if (closing_) return;
  }
}

void ClientFeed::Handle(const Unsubscribe& message) {
  for (const std::uint32_t id : message.ids) {
    const auto found = subscriptions_.find(id);
    if (found == subscriptions_.end()) {
      Complain(fmt::format("unsubscribe: there is no subscription {}", id));
      if (closing_) return;
      continue;
    }
    while (!found->second.waiting.empty()) Erase(found->second.waiting.back());
    const std::uint32_t channel = found->second.channel;
    subscription_of_.erase(channel);
    subscriptions_.erase(found);
    host_.Left(channel);
  }
}

std::string ClientFeed::WhyNotAdvertised(const ClientChannel& channel) const {
  if (role_ == ROLE_OBSERVER) return "an observer may only watch, and stop robots";
  if (!catalog_.goal_topics.contains(channel.topic)) {
    return "clients publish goals only, on /ROBOT/goal_pose";
  }
  if (std::ranges::find(kPoseSchemas, channel.schema_name) == kPoseSchemas.end()) {
    return fmt::format("{} is not geometry_msgs/msg/PoseStamped", channel.schema_name);
  }
  if (!IsEncoding(channel.encoding)) return "the encoding is neither cdr nor json";
  if (published_.contains(channel.id)) return "its id is in use";
  if (published_.size() >= kClientChannels) return "there are too many channels";
  return "";
}

void ClientFeed::Handle(const ClientAdvertise& message) {
  for (const ClientChannel& channel : message.channels) {
    const std::string why = WhyNotAdvertised(channel);
    if (why.empty()) {
      published_[channel.id] = channel;
    } else {
      Complain(fmt::format("advertise {}: {}", Readable(channel.topic), Readable(why)));
    }
    if (closing_) return;
  }
}

void ClientFeed::Handle(const ClientUnadvertise& message) {
  for (const std::uint32_t id : message.ids) published_.erase(id);
}

void ClientFeed::Handle(const ClientPublish& message) {
  const auto found = published_.find(message.channel);
  if (found == published_.end()) {
    return Complain(fmt::format("publish: channel {} is not advertised", message.channel));
  }
  const ClientChannel& channel = found->second;
  if (!host_.Ask(number_, PublishGoal{channel.topic, channel.encoding, message.payload})) {
    Complain("publish: the service does not keep up");
  }
}

void ClientFeed::Handle(const CallService& message) {
  std::string why;
  if (message.service == 0 || message.service > catalog_.services.size()) {
    why = fmt::format("there is no service {}", message.service);
  } else if (!IsEncoding(message.encoding)) {
    why = "the encoding is neither cdr nor json";
  } else if (!host_.Ask(number_, message)) {
    why = "the service does not keep up";
  }
  if (!why.empty()) Add(ServiceFailureText(message.service, message.call, why), true);
}

void ClientFeed::Handle(const FetchAsset& message) {
  if (!host_.Ask(number_, message)) {
    Add(AssetErrorBytes(message.request_id, "the service does not keep up"), false);
  }
}

void ClientFeed::Handle(const GetParameters& message) {
  Add(ParameterValuesText(catalog_.parameters, message.names, message.id), true);
}

void ClientFeed::Handle(const SetParameters& message) {
  for (const std::string& name : message.names) {
    Complain(fmt::format("{} cannot be set while the service runs", Readable(name)));
    if (closing_) return;
  }
  // So that the client shows what holds. Without names it would get all.
  if (message.id && !message.names.empty()) {
    Add(ParameterValuesText(catalog_.parameters, message.names, message.id), true);
  }
}

void ClientFeed::Handle(const WatchGraph& message) {
  watches_graph_ = message.on;
  SendGraph(host_.graph());
}

}  // namespace conav::foxglove
