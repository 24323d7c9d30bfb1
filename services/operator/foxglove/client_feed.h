#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "common/runtime/clock.h"
#include "operator/foxglove/foxglove_messages.h"
#include "operator/gateway/page_feed.h"
#include "operator/gateway/web_server.h"

// One user: the server; apart because it needs no socket, and is fuzzed.

namespace conav::foxglove {

using operators::SocketMessage;

/// A message of a channel on its way to clients.
struct ChannelMessage {
  std::uint32_t channel = 0;
  std::uint64_t time_ns = 0;  // of the server
  std::shared_ptr<const std::vector<std::uint8_t>> payload;
};

/// What becomes of messages that a client is too slow for.
enum class Backlog {
  kNewest,  // a newer one replaces the one that waits: pictures of a stream
  kQueue,   // up to kQueueMessages wait
};

/// What is the same for all clients. Index = id - 1.
struct Catalog {
  struct Entry {
    Channel channel;
    Backlog backlog = Backlog::kQueue;
    std::size_t history = 0;  // newest messages that a late subscriber gets
  };
  std::vector<Entry> channels;
  std::vector<Service> services;
  std::set<std::string> goal_topics;  // on which clients may publish
  Parameters parameters;
  std::string session;  // names this run; clients' names are made of it
};

/// Publishes `payload`, a PoseStamped in `encoding`, on `topic`.
struct PublishGoal {
  std::string topic;
  std::string encoding;
  std::string payload;
};
/// What a client asks of the service. Each is answered by ClientFeed::Add.
using Asked = std::variant<PublishGoal, CallService, FetchAsset>;

/// What a client's feed needs of its server.
class FeedHost {
 public:
  virtual ~FeedHost() = default;
  /// A client has subscribed to this channel: gives what a late subscriber gets.
  virtual std::vector<ChannelMessage> Join(std::uint32_t channel) = 0;
  /// A client no longer wants a channel.
  virtual void Left(std::uint32_t channel) = 0;
  /// False when too much waits for the service already.
  virtual bool Ask(std::uint64_t client, Asked asked) = 0;
  /// The connection graph as it is; null before the first.
  virtual std::shared_ptr<const std::string> graph() = 0;
  virtual void CountSkipped(std::uint64_t client, std::uint64_t messages) = 0;
};

/// One client's connection without its socket: takes its messages, queues what it subscribes to.
///
/// A client costs its greeting, at most kReplies answers or `queue_bytes` of them, and
/// `queue_bytes` of messages, whatever it does: beyond that it is closed, or its oldest messages are
/// skipped, and a status says so once a second. Its messages count against the limits of a page (GatewayOptions). What it sends
/// that cannot be read, or asks for that it may not have, is answered with a status; too much, or
/// too often, closes it.
/// Threads: the server's. Never throws for what a client sends.
class ClientFeed final : public operators::SocketFeed {
 public:
  static constexpr std::size_t kReplies = 1000;
  /// Of one subscription with Backlog::kQueue.
  static constexpr std::size_t kQueueMessages = 200;
  static constexpr std::size_t kClientChannels = 100;
  /// Messages that cannot be read, before the client is closed.
  static constexpr int kFaults = 20;

  struct Limits {
    std::size_t queue_bytes = std::size_t{8} << 20;
    double message_rate = 50.0;
    int message_burst = 200;
    double time_rate_hz = 30.0;
  };

  /// All outlive it. `number`: of the connection.
  ClientFeed(const Catalog& catalog, FeedHost& host, std::uint64_t number, console::Role role,
             const Limits& limits, Clock::TimePoint now);
  ~ClientFeed() override;

  void Take(std::string_view bytes, bool is_text, Clock::TimePoint now) override;
  std::optional<SocketMessage> Next(Clock::TimePoint now) override;
  std::optional<Clock::TimePoint> due() const override { return due_; }
  bool finished() const override { return closing_ && replies_.empty(); }
  bool retry() const override { return retry_; }
  void End(std::string reason) override { Close(std::move(reason), true); }

  /// An answer, or a text that all get; `is_text`: JSON.
  void Add(std::string bytes, bool is_text);
  /// To the subscription of that channel, if there is one.
  void Add(const ChannelMessage& message);
  void SetTime(std::uint64_t time_ns) { time_ns_ = time_ns; }
  /// Sends it if the client watches it.
  void SendGraph(const std::shared_ptr<const std::string>& graph);

  console::Role role() const { return role_; }
  /// Why the client was closed for what it did; empty = it was not.
  const std::string& fault() const { return fault_; }
  std::size_t queued_bytes() const { return queued_bytes_; }

 private:
  struct Waiting {
    std::uint32_t subscription = 0;
    ChannelMessage message;
  };
  struct Subscription {
    std::uint32_t channel = 0;
    std::deque<std::uint64_t> waiting;  // keys of queue_, oldest first
  };

  void Handle(const Subscribe& message);
  void Handle(const Unsubscribe& message);
  void Handle(const ClientAdvertise& message);
  void Handle(const ClientUnadvertise& message);
  void Handle(const GetParameters& message);
  void Handle(const SetParameters& message);
  void Handle(const WatchGraph& message);
  void Handle(const FetchAsset& message);
  void Handle(const ClientPublish& message);
  void Handle(const CallService& message);

  std::string WhyNotAdvertised(const ClientChannel& channel) const;
  void Complain(const std::string& message);
  void Close(std::string reason, bool retry);
  void Erase(std::uint64_t key);
  std::optional<SocketMessage> NextTime(Clock::TimePoint now);
  std::optional<SocketMessage> SkippedStatus(Clock::TimePoint now);

  const Catalog& catalog_;
  FeedHost& host_;
  const std::uint64_t number_;
  const console::Role role_;
  const Limits limits_;
  operators::RateLimit rate_;
  std::deque<SocketMessage> replies_;
  std::size_t reply_bytes_ = 0;
  std::size_t reply_limit_ = 0;                             // bytes
  std::map<std::uint32_t, Subscription> subscriptions_;     // by the client's id
  std::map<std::uint32_t, std::uint32_t> subscription_of_;  // by channel
  std::map<std::uint32_t, ClientChannel> published_;        // by the client's id
  std::map<std::uint64_t, Waiting> queue_;                  // in the order of arrival
  std::uint64_t last_key_ = 0;
  std::size_t queued_bytes_ = 0;
  bool watches_graph_ = false;
  std::uint64_t time_ns_ = 0;
  std::uint64_t time_sent_ns_ = 0;
  Clock::TimePoint time_sent_at_{};
  std::uint64_t skipped_ = 0;  // not yet told
  Clock::TimePoint skipped_told_at_{};
  std::optional<Clock::TimePoint> due_;
  int faults_ = 0;
  bool closing_ = false;
  bool retry_ = false;
  std::string fault_;
};

}  // namespace conav::foxglove
