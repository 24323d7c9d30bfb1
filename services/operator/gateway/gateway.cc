#include "operator/gateway/gateway.h"

#include <fmt/core.h>
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>

#include "common/runtime/log.h"
#include "operator/gateway/web_server.h"

namespace conav::operators {
namespace {

prometheus::Gauge& AddGauge(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Family<prometheus::Counter>& AddCounters(prometheus::Registry& registry,
                                                     const char* name, const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

}  // namespace

GatewayMetrics::GatewayMetrics()
    : pages_(AddGauge(registry_, "conav_console_pages", "Connected pages of the console")),
      connections_(AddGauge(registry_, "conav_console_connections", "Open TCP connections")),
      shown_bytes_(
          AddGauge(registry_, "conav_console_shown_bytes",
                   "State that the service sends to a new page, without pictures and live views")),
      messages_in_(AddCounters(registry_, "conav_console_received_messages_total",
                               "WebSocket messages from pages")
                       .Add({})),
      messages_out_(
          AddCounters(registry_, "conav_console_sent_messages_total", "WebSocket messages to pages")
              .Add({})),
      bytes_in_(AddCounters(registry_, "conav_console_received_bytes_total",
                            "Payload of WebSocket messages from pages")
                    .Add({})),
      bytes_out_(AddCounters(registry_, "conav_console_sent_bytes_total",
                             "Payload of WebSocket messages to pages")
                     .Add({})),
      skipped_frames_(AddCounters(registry_, "conav_console_skipped_frames_total",
                                  "Live-view frames skipped because a page was too slow")
                          .Add({})),
      refused_pages_(AddCounters(registry_, "conav_console_refused_pages_total",
                                 "Pages refused or closed because of what they sent")
                         .Add({})),
      requests_(AddCounters(registry_, "conav_console_http_requests_total",
                            "HTTP requests, by status")) {}

void GatewayMetrics::SetPages(int pages) { pages_.Set(pages); }
void GatewayMetrics::SetConnections(int connections) { connections_.Set(connections); }

void GatewayMetrics::SetShownBytes(std::size_t bytes) {
  shown_bytes_.Set(static_cast<double>(bytes));
}

void GatewayMetrics::CountRequest(unsigned status) {
  requests_.Add({{"status", std::to_string(status)}}).Increment();
}

void GatewayMetrics::CountMessage(bool sent, std::size_t bytes) {
  (sent ? messages_out_ : messages_in_).Increment();
  (sent ? bytes_out_ : bytes_in_).Increment(static_cast<double>(bytes));
}

void GatewayMetrics::CountSkippedFrames(std::size_t frames) {
  skipped_frames_.Increment(static_cast<double>(frames));
}

void GatewayMetrics::CountRefusedPage() { refused_pages_.Increment(); }

std::string GatewayMetrics::Text() const {
  return prometheus::TextSerializer().Serialize(registry_.Collect());
}

namespace {

/// Pages that have not said Hello.
constexpr int kNewPagesLimit = 16;
/// Bytes of requests that the service has not taken; pages with more are closed and come back
/// later.
constexpr std::size_t kWaitingLimit = 8U * 1024U * 1024U;

/// Requests only: joining and leaving is always delivered.
std::size_t BytesOf(const std::vector<PageEvent>& events) {
  std::size_t bytes = 0;
  for (const PageEvent& event : events) {
    const auto* asked = std::get_if<PageAsked>(&event.body);
    if (asked != nullptr) bytes += sizeof(PageEvent) + asked->request.ByteSizeLong();
  }
  return bytes;
}

WebFiles LoadPage(const GatewayOptions& options) {
  return WebFiles(options.web.empty() ? DefaultWebFolder() : std::filesystem::path(options.web));
}

/// Pages of an earlier run get everything again.
console::Welcome WithRun(console::Welcome welcome) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  if (welcome.run().empty()) welcome.set_run(fmt::format("{:x}", now.count()));
  return welcome;
}

}  // namespace

class Gateway::Server final : public SocketHost {
  /// A page's feed at its WebSocket.
  class PageSocket final : public SocketFeed {
   public:
    /// False when too much waits for the service already: nothing was delivered.
    using Deliver = std::function<bool(std::vector<PageEvent>)>;

    PageSocket(const PageContext& context, std::uint64_t number, const std::string& address,
               Deliver deliver, GatewayMetrics& metrics)
        : address_(address),
          feed_(context, number, Clock::TimePoint::clock::now(), address),
          deliver_(std::move(deliver)),
          metrics_(metrics) {}

    void Take(std::string_view bytes, bool /*is_text*/, Clock::TimePoint now) override {
      auto events = feed_.Take(bytes, now, WallSeconds());
      if (!deliver_(std::move(events))) feed_.Close("the service does not keep up", true);
    }
    std::optional<SocketMessage> Next(Clock::TimePoint now) override {
      auto message = feed_.Next(now);
      metrics_.CountSkippedFrames(feed_.TakeFramesSkipped());
      if (!message) return std::nullopt;
      return SocketMessage{*std::move(message), nullptr, false};
    }
    std::optional<Clock::TimePoint> due() const override { return feed_.due(); }
    bool finished() const override { return feed_.finished(); }
    bool is_kept() const override { return feed_.is_kept(); }
    bool retry() const override { return feed_.retry(); }
    void End(std::string reason) override { feed_.End(std::move(reason)); }

    PageFeed& feed() { return feed_; }
    const std::string& address() const { return address_; }

   private:
    std::string address_;
    PageFeed feed_;
    Deliver deliver_;
    GatewayMetrics& metrics_;
  };

 public:
  Server(const GatewayOptions& options, Shared shared, console::Welcome welcome,
         std::function<void()> wake)
      : options_(options),
        shared_(shared),
        welcome_(WithRun(std::move(welcome))),
        wake_(std::move(wake)),
        access_(options.token_file),
        web_(std::make_unique<WebServer>(options_, "operator.console", *this)),
        routes_(options_, LoadPage(options_),
                {shared.snapshots, access_, [this] { return readiness(); },
                 [this] { return Metrics(); }}) {
    web_->Start();
  }

  ~Server() override { web_->Stop(); }

  int port() const { return web_->port(); }
  std::string url() const { return web_->url(); }

  void Notify() {
    if (notified_.exchange(true)) return;
    web_->Post([this] {
      notified_ = false;
      web_->PumpAll();
    });
  }

  std::vector<PageEvent> Take() {
    const std::lock_guard lock(mutex_);
    waiting_bytes_ = 0;
    return std::exchange(events_, {});
  }

  void Send(std::uint64_t page, const console::Reply& reply) {
    web_->Post([this, page, reply] {
      const auto found = pages_.find(page);
      if (found == pages_.end()) return;
      found->second->feed().Add(reply);
      web_->Pump(page);
    });
  }

  void SetReadiness(Readiness readiness) {
    const std::lock_guard lock(mutex_);
    readiness_ = std::move(readiness);
    readiness_set_at_ = Clock::TimePoint::clock::now();
  }

  HttpResponse Answer(const HttpRequest& request) override {
    HttpResponse response = routes_.Answer(request);
    metrics_.CountRequest(response.status);
    return response;
  }

  HttpResponse Refuse(unsigned status, const std::string& why) override {
    metrics_.CountRequest(status);
    return HttpRoutes::Refuse(status, why);
  }

  std::optional<HttpResponse> RefuseSocket(const HttpRequest& request) override {
    unsigned status = 403;
    std::string why = WhyForeign(options_, request.host, request.origin);
    if (why.empty() && request.target != "/ws") {
      status = 404;
      why = "pages connect to /ws";
    }
    if (why.empty()) return std::nullopt;
    NoteRefused(why);
    return Refuse(status, why);
  }

  std::unique_ptr<SocketFeed> Open(std::uint64_t number, const HttpRequest& request) override {
    if (CountOf(&PageFeed::is_new) >= kNewPagesLimit) CloseOldestNewPage();
    const PageContext context{
        options_,       shared_.updates,
        shared_.frames, welcome_,
        access_,        [this] { return CountOf(&PageFeed::has_joined) < options_.max_pages; }};
    auto page = std::make_unique<PageSocket>(
        context, number, request.address,
        [this](std::vector<PageEvent> events) { return Deliver(std::move(events)); }, metrics_);
    pages_[number] = page.get();
    CountPages();
    return page;
  }

  void Leave(std::uint64_t number) override {
    const auto found = pages_.find(number);
    if (found == pages_.end()) return;
    const PageFeed& feed = found->second->feed();
    if (!feed.fault().empty()) NoteRefused(feed.fault());
    const std::optional<PageIdentity> who = feed.identity();
    pages_.erase(found);
    CountPages();
    if (who) Deliver({{number, *who, PageLeft{}}});
  }

  void CountMessage(bool sent, std::size_t bytes) override { metrics_.CountMessage(sent, bytes); }
  void CountConnections(int connections) override { metrics_.SetConnections(connections); }

  void NoteRefused(const std::string& why) override {
    metrics_.CountRefusedPage();
    if (const auto held_back = refusals_logged_.Allow()) {
      LOG_WARNING("page of the console refused", "reason", why, "held_back", *held_back);
    }
  }

 private:
  bool Deliver(std::vector<PageEvent> events) {
    if (events.empty()) return true;
    const std::size_t bytes = BytesOf(events);
    {
      const std::lock_guard lock(mutex_);
      if (bytes > 0 && waiting_bytes_ + bytes > kWaitingLimit) return false;
      waiting_bytes_ += bytes;
      events_.insert(events_.end(), std::make_move_iterator(events.begin()),
                     std::make_move_iterator(events.end()));
    }
    if (wake_) wake_();
    return true;
  }

  int CountOf(bool (PageFeed::*is)() const) const {
    return static_cast<int>(std::count_if(pages_.begin(), pages_.end(), [is](const auto& page) {
      return (page.second->feed().*is)();
    }));
  }

  /// Pages say Hello at once: many silent connections must not keep others out. Of the address that
  /// has most of them.
  void CloseOldestNewPage() {
    std::map<std::string, int> waiting;
    for (const auto& [number, page] : pages_) {
      if (page->feed().is_new()) ++waiting[page->address()];
    }
    const std::string& most = std::ranges::max_element(waiting, {}, [](const auto& entry) {
                                return entry.second;
                              })->first;
    const auto oldest = std::ranges::find_if(pages_, [&](const auto& page) {
      return page.second->feed().is_new() && page.second->address() == most;
    });
    oldest->second->feed().Close("no Hello arrived, and other pages wait", true);
    web_->Pump(oldest->first);
  }

  void CountPages() { metrics_.SetPages(static_cast<int>(pages_.size())); }

  Readiness readiness() const {
    const std::lock_guard lock(mutex_);
    Readiness readiness = readiness_;
    readiness.age = Clock::TimePoint::clock::now() - readiness_set_at_;
    return readiness;
  }
  std::string Metrics() {
    metrics_.SetShownBytes(shared_.updates.bytes());
    return metrics_.Text();
  }

  const GatewayOptions options_;
  Shared shared_;
  console::Welcome welcome_;
  std::function<void()> wake_;
  GatewayMetrics metrics_;
  std::atomic<bool> notified_{false};
  LogLimit refusals_logged_;
  mutable std::mutex mutex_;  // guards the four below
  std::vector<PageEvent> events_;
  std::size_t waiting_bytes_ = 0;  // of them
  Readiness readiness_;
  Clock::TimePoint readiness_set_at_ = Clock::TimePoint::clock::now();
  AccessControl access_;
  std::map<std::uint64_t, PageSocket*> pages_;  // owned by their connections
  std::unique_ptr<WebServer> web_;
  HttpRoutes routes_;
};

Gateway::Gateway(const GatewayOptions& options, Shared shared, console::Welcome welcome,
                 std::function<void()> wake)
    : server_(std::make_unique<Server>(options, shared, std::move(welcome), std::move(wake))) {}

Gateway::~Gateway() = default;

int Gateway::port() const { return server_->port(); }
std::string Gateway::url() const { return server_->url(); }
void Gateway::Notify() { server_->Notify(); }
std::vector<PageEvent> Gateway::Take() { return server_->Take(); }
void Gateway::Send(std::uint64_t page, const console::Reply& reply) { server_->Send(page, reply); }
void Gateway::SetReadiness(Readiness readiness) { server_->SetReadiness(std::move(readiness)); }

}  // namespace conav::operators
