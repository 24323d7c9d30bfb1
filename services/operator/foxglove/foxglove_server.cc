#include "operator/foxglove/foxglove_server.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "operator/gateway/http_routes.h"
#include "operator/gateway/web_server.h"

namespace conav::foxglove {
namespace {

using operators::AccessControl;
using operators::FoxgloveOptions;
using operators::HttpRequest;
using operators::HttpResponse;
using operators::HttpRoutes;
using operators::SocketFeed;

/// Of messages between the bus and the server's thread.
constexpr std::size_t kPendingLimit = std::size_t{64} << 20;
/// Requests that the service has not taken, and their bytes.
constexpr std::size_t kAskedLimit = 1000;
constexpr std::size_t kAskedBytes = std::size_t{8} << 20;

operators::GatewayOptions WebOptions(const FoxgloveOptions& options,
                                     operators::GatewayOptions console) {
  console.port = options.port;
  console.origins = options.origins;
  console.origins_key = "operator.foxglove.origins";
  return console;
}

/// "token" of "/?token=0123456789abcdef&...". Tokens in addresses are plain: nothing is unescaped.
std::string_view QueryToken(std::string_view target) {
  constexpr std::string_view kKey = "token=";
  const auto query = target.find('?');
  std::string_view rest = query == std::string_view::npos ? "" : target.substr(query + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    if (pair.starts_with(kKey)) return pair.substr(kKey.size());
    rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
  }
  return "";
}

std::string_view Trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::string SubprotocolOf(std::string_view offered) {
  while (!offered.empty()) {
    const std::string_view one = offered.substr(0, offered.find(','));
    const auto known = std::ranges::find(kSubprotocols, Trimmed(one));
    if (known != kSubprotocols.end()) return std::string(*known);
    offered.remove_prefix(std::min(one.size() + 1, offered.size()));
  }
  return "";
}

bool IsNear(std::uint64_t a, std::uint64_t b) {
  return (a < b ? b - a : a - b) <= FoxgloveServer::kNearNs;
}

std::size_t SizeOf(const Asked& asked) {
  const auto* goal = std::get_if<PublishGoal>(&asked);
  const auto* call = std::get_if<CallService>(&asked);
  return goal != nullptr ? goal->payload.size() : call != nullptr ? call->payload.size() : 0;
}

}  // namespace

class FoxgloveServer::Server final : public operators::SocketHost, public FeedHost {
 public:
  Server(const FoxgloveOptions& options, const operators::GatewayOptions& console, Catalog catalog,
         std::function<void()> wake)
      : options_(WebOptions(options, console)),
        catalog_(std::move(catalog)),
        limits_{static_cast<std::size_t>(options.queue_mib * 1024.0 * 1024.0), console.message_rate,
                console.message_burst, console.update_rate_hz},
        wake_(std::move(wake)),
        access_(options_.token_file),
        web_(options_, "operator.foxglove", *this) {
    web_.Start();
  }
  ~Server() override { web_.Stop(); }

  std::string url() const {
    const std::string http = web_.url();  // http:// or https://
    return "ws" + http.substr(4);
  }

  std::set<std::uint32_t> wanted() const {
    const std::lock_guard lock(mutex_);
    std::set<std::uint32_t> wanted;
    for (const auto& [channel, count] : subscribers_) wanted.insert(channel);
    return wanted;
  }
  std::vector<ClientRequest> Take() {
    const std::lock_guard lock(mutex_);
    asked_bytes_ = 0;
    return std::exchange(asked_, {});
  }
  void Send(std::uint64_t client, std::string bytes, bool is_text) {
    web_.Post([this, client, bytes = std::move(bytes), is_text]() mutable {
      const auto found = clients_.find(client);
      if (found == clients_.end()) return;
      found->second.feed->Add(std::move(bytes), is_text);
      web_.Pump(client);
    });
  }
  void SetGraph(std::string text) {
    web_.Post([this, text = std::make_shared<const std::string>(std::move(text))] {
      graph_ = text;
      for (const auto& [number, client] : clients_) client.feed->SendGraph(graph_);
      web_.PumpAll();
    });
  }
  void SetTime(std::uint64_t time_ns) {
    const std::uint64_t before = time_ns_;
    if (time_ns == before || (time_ns < before && IsNear(time_ns, before))) return;
    time_ns_ = time_ns;
    Notify();
  }
  void Put(std::uint32_t channel, std::vector<std::uint8_t> payload,
           std::optional<std::uint64_t> stamp_ns) {
    std::uint64_t time_ns = time_ns_;
    if (stamp_ns && IsNear(*stamp_ns, time_ns)) SetTime(time_ns = *stamp_ns);
    {
      const std::lock_guard lock(mutex_);
      if (pending_bytes_ + payload.size() > kPendingLimit) {
        ++figures_.dropped;
        return;
      }
      pending_bytes_ += payload.size();
      pending_.push_back({channel, time_ns,
                          std::make_shared<const std::vector<std::uint8_t>>(std::move(payload))});
    }
    Notify();
  }
  /// In order with what is put: a message without payload.
  void Forget(std::uint32_t channel) {
    {
      const std::lock_guard lock(mutex_);
      pending_.push_back({channel, 0, nullptr});
    }
    Notify();
  }
  Figures figures() const {
    const std::lock_guard lock(mutex_);
    return figures_;
  }

  HttpResponse Answer(const HttpRequest& /*request*/) override {
    return HttpRoutes::Refuse(426, "Foxglove's protocol is spoken here, over a WebSocket");
  }
  HttpResponse Refuse(unsigned status, const std::string& why) override {
    return HttpRoutes::Refuse(status, why);
  }
  std::optional<HttpResponse> RefuseSocket(const HttpRequest& request) override {
    unsigned status = 403;
    std::string why = WhyForeign(options_, request.host, request.origin);
    const auto admitted = why.empty() ? Admit(request) : AccessControl::Admission();
    if (!admitted) {
      status = admitted.error().code == ErrorCode::kUnavailable ? 429 : 401;
      why = admitted.error().text + ": connect to .../?token=...";
    }
    if (why.empty() && SubprotocolOf(request.protocols).empty()) {
      status = 400;
      why = "the subprotocol is neither foxglove.sdk.v1 nor foxglove.websocket.v1";
    }
    if (why.empty() && static_cast<int>(clients_.size()) >= options_.max_pages) {
      status = 503;
      why = fmt::format("{} clients are connected, the limit of operator.console.max_pages",
                        clients_.size());
    }
    if (why.empty()) return std::nullopt;
    NoteRefused(why);
    return HttpRoutes::Refuse(status, why);
  }
  std::string SelectProtocol(const HttpRequest& request) override {
    return SubprotocolOf(request.protocols);
  }
  std::unique_ptr<SocketFeed> Open(std::uint64_t number, const HttpRequest& request) override {
    const auto admitted = Admit(request).value_or(AccessControl::Admission{console::ROLE_OBSERVER});
    const console::Role role = admitted.role;
    auto feed = std::make_unique<ClientFeed>(catalog_, *this, number, role, limits_,
                                             Clock::TimePoint::clock::now());
    feed->SetTime(time_ns_);
    const std::string secret = fmt::format("{}\n{}", catalog_.session, number);
    const std::string name = admitted.name.empty() ? "foxglove" : admitted.name;
    clients_[number] = {feed.get(), name + "/" + Sha256Hex(secret).substr(0, 16), admitted};
    CountClients();
    LOG_INFO("foxglove client", "client", clients_[number].name, "origin",
             Readable(request.origin));
    return feed;
  }
  void Leave(std::uint64_t number) override {
    const auto found = clients_.find(number);
    if (found == clients_.end()) return;
    const std::string fault = found->second.feed->fault();
    LOG_INFO("foxglove client left", "client", found->second.name, "reason",
             fault.empty() ? "closed" : fault);
    clients_.erase(found);
    CountClients();
  }
  void CountMessage(bool sent, std::size_t /*bytes*/) override {
    const std::lock_guard lock(mutex_);
    if (sent) ++figures_.sent;
  }
  void CountConnections(int /*connections*/) override {}
  void NoteRefused(const std::string& why) override {
    if (const auto held_back = refusals_logged_.Allow()) {
      LOG_WARNING("foxglove client refused", "reason", why, "held_back", *held_back);
    }
  }

  std::vector<ChannelMessage> Join(std::uint32_t channel) override {
    {
      const std::lock_guard lock(mutex_);
      ++subscribers_[channel];
    }
    wake_();
    const auto kept = history_.find(channel);
    if (kept == history_.end()) return {};
    return {kept->second.begin(), kept->second.end()};
  }
  void Left(std::uint32_t channel) override {
    {
      const std::lock_guard lock(mutex_);
      if (--subscribers_[channel] <= 0) subscribers_.erase(channel);
    }
    wake_();
  }
  bool Ask(std::uint64_t client, Asked body) override {
    const auto found = clients_.find(client);
    {
      const std::lock_guard lock(mutex_);
      const std::size_t size = SizeOf(body);
      if (asked_.size() >= kAskedLimit || asked_bytes_ + size > kAskedBytes) return false;
      asked_bytes_ += size;
      asked_.push_back({client, found->second.name, found->second.admission.role, std::move(body)});
    }
    wake_();
    return true;
  }
  std::shared_ptr<const std::string> graph() override { return graph_; }
  void CountSkipped(std::uint64_t client, std::uint64_t messages) override {
    {
      const std::lock_guard lock(mutex_);
      figures_.skipped += messages;
    }
    if (const auto held_back = skips_logged_.Allow()) {
      LOG_WARNING("foxglove client too slow", "client", clients_.at(client).name, "skipped",
                  messages, "held_back", *held_back);
    }
  }

 private:
  struct Client {
    ClientFeed* feed = nullptr;  // owned by its connection
    std::string name;
    AccessControl::Admission admission;
  };

  Result<AccessControl::Admission> Admit(const HttpRequest& request) {
    const std::string_view bearer = operators::BearerToken(request.authorization);
    return access_.Admit(bearer.empty() ? QueryToken(request.target) : bearer, request.address,
                         Clock::TimePoint::clock::now());
  }

  void Notify() {
    if (notified_.exchange(true)) return;
    web_.Post([this] {
      notified_ = false;
      Distribute();
    });
  }
  void Distribute() {
    std::vector<ChannelMessage> messages;
    {
      const std::lock_guard lock(mutex_);
      messages = std::exchange(pending_, {});
      pending_bytes_ = 0;
    }
    for (ChannelMessage& message : messages) {
      if (message.payload == nullptr) {
        history_.erase(message.channel);
        continue;
      }
      for (const auto& [number, client] : clients_) client.feed->Add(message);
      const std::size_t kept = catalog_.channels[message.channel - 1].history;
      if (kept == 0) continue;
      auto& history = history_[message.channel];
      if (history.size() >= kept) history.pop_front();
      history.push_back(std::move(message));
    }
    for (const auto& [number, client] : clients_) {
      client.feed->SetTime(time_ns_);
      if (!access_.MayStay(client.admission, Clock::TimePoint::clock::now())) {
        client.feed->End("the token was revoked, or has ended");
      }
    }
    web_.PumpAll();
  }
  void CountClients() {
    const std::lock_guard lock(mutex_);
    figures_.clients = static_cast<int>(clients_.size());
  }

  const operators::GatewayOptions options_;
  const Catalog catalog_;
  const ClientFeed::Limits limits_;
  const std::function<void()> wake_;
  LogLimit refusals_logged_;
  LogLimit skips_logged_{std::chrono::seconds(10)};
  std::atomic<bool> notified_{false};
  std::atomic<std::uint64_t> time_ns_{0};
  mutable std::mutex mutex_;                  // guards what follows, up to the empty line
  std::map<std::uint32_t, int> subscribers_;  // by channel
  std::vector<ClientRequest> asked_;
  std::size_t asked_bytes_ = 0;
  std::vector<ChannelMessage> pending_;
  std::size_t pending_bytes_ = 0;
  Figures figures_;

  AccessControl access_;
  std::map<std::uint64_t, Client> clients_;
  std::map<std::uint32_t, std::deque<ChannelMessage>> history_;  // by channel
  std::shared_ptr<const std::string> graph_;
  operators::WebServer web_;
};

FoxgloveServer::FoxgloveServer(const operators::FoxgloveOptions& options,
                               const operators::GatewayOptions& console, Catalog catalog,
                               std::function<void()> wake)
    : server_(std::make_unique<Server>(options, console, std::move(catalog), std::move(wake))) {}

FoxgloveServer::~FoxgloveServer() = default;

std::string FoxgloveServer::url() const { return server_->url(); }
std::set<std::uint32_t> FoxgloveServer::wanted() const { return server_->wanted(); }
std::vector<ClientRequest> FoxgloveServer::Take() { return server_->Take(); }
void FoxgloveServer::Send(std::uint64_t client, std::string bytes, bool is_text) {
  server_->Send(client, std::move(bytes), is_text);
}
void FoxgloveServer::SetGraph(std::string text) { server_->SetGraph(std::move(text)); }
void FoxgloveServer::SetTime(std::uint64_t time_ns) { server_->SetTime(time_ns); }
void FoxgloveServer::Put(std::uint32_t channel, std::vector<std::uint8_t> payload,
                         std::optional<std::uint64_t> stamp_ns) {
  server_->Put(channel, std::move(payload), stamp_ns);
}
void FoxgloveServer::Forget(std::uint32_t channel) { server_->Forget(channel); }
FoxgloveServer::Figures FoxgloveServer::figures() const { return server_->figures(); }

}  // namespace conav::foxglove
