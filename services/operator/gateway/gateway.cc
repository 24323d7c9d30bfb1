#include "operator/gateway/gateway.h"

#include <fmt/format.h>
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <map>
#include <mutex>
#include <thread>

#include "common/runtime/log.h"
#include "operator/gateway/http_connection.h"

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

using asio::ip::tcp;

constexpr std::chrono::milliseconds kGoodbyeLimit{500};
constexpr std::chrono::milliseconds kAcceptPause{100};
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

GatewayOptions Checked(const GatewayOptions& options) {
  if (const auto valid = CheckAccess(options); !valid) throw StartupError(valid.error().text);
  return options;
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

std::optional<asio::ssl::context> MakeTls(const ConsoleTls& tls) {
  if (!tls.on()) return std::nullopt;
  asio::ssl::context context(asio::ssl::context::tls_server);
  try {
    context.set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_tlsv1 |
                        asio::ssl::context::no_tlsv1_1);
    context.use_certificate_chain_file(tls.certificate);
    context.use_private_key_file(tls.key, asio::ssl::context::pem);
  } catch (const boost::system::system_error& error) {
    throw StartupError(fmt::format("operator.console.tls: {} with {}: {}", tls.certificate, tls.key,
                                   error.code().message()));
  }
  return context;
}

}  // namespace

class Gateway::Server final : public ConnectionHost {
 public:
  Server(const GatewayOptions& options, Shared shared, console::Welcome welcome,
         std::function<void()> wake)
      : options_(Checked(options)),
        shared_(shared),
        welcome_(WithRun(std::move(welcome))),
        wake_(std::move(wake)),
        tls_(MakeTls(options_.tls)),
        routes_(options_, LoadPage(options_),
                {shared.snapshots, [this] { return readiness(); }, [this] { return Metrics(); }}),
        acceptor_(io_) {
    Listen();
    Accept();
    thread_ = std::thread([this] { io_.run(); });
  }

  ~Server() override {
    asio::post(io_, [this] { SayGoodbye(); });
    thread_.join();
    pages_.clear();  // while io_ exists, which their sockets belong to
  }

  int port() const { return port_; }
  bool has_tls() const { return tls_.has_value(); }
  const GatewayOptions& options() const override { return options_; }

  void Notify() {
    if (notified_.exchange(true)) return;
    asio::post(io_, [this] {
      notified_ = false;
      for (const auto& page : LivePages()) page->Pump();
    });
  }

  std::vector<PageEvent> Take() {
    const std::lock_guard lock(mutex_);
    waiting_bytes_ = 0;
    return std::exchange(events_, {});
  }

  void Send(std::uint64_t page, const console::Reply& reply) {
    asio::post(io_, [this, page, reply] {
      const auto found = pages_.find(page);
      if (found == pages_.end()) return;
      found->second->feed().Add(reply);
      found->second->Pump();
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

  std::optional<HttpResponse> RefusePage(const HttpRequest& request) override {
    unsigned status = 403;
    std::string why = WhyForeign(options_, request.host, request.origin);
    if (why.empty() && request.target != "/ws") {
      status = 404;
      why = "pages connect to /ws";
    }
    if (why.empty()) return std::nullopt;
    Note(why);
    return Refuse(status, why);
  }

  PageContext page_context() override {
    return {options_, shared_.updates, shared_.frames, welcome_,
            [this] { return CountOf(&PageFeed::has_joined) < options_.max_pages; }};
  }

  std::uint64_t Enter(const std::shared_ptr<PageConnection>& page) override {
    if (CountOf(&PageFeed::is_new) >= kNewPagesLimit) CloseOldestNewPage();
    pages_[++last_page_] = page;
    CountPages();
    return last_page_;
  }

  void Leave(std::uint64_t page) override {
    const auto found = pages_.find(page);
    if (found == pages_.end()) return;
    const PageFeed& feed = found->second->feed();
    if (!feed.fault().empty()) Note(feed.fault());
    const std::optional<PageIdentity> who = feed.identity();
    pages_.erase(found);
    CountPages();
    if (who) Deliver({{page, *who, PageLeft{}}});
    if (leaving_ && pages_.empty()) io_.stop();
  }

  bool Deliver(std::vector<PageEvent> events) override {
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

  void CountMessage(bool sent, std::size_t bytes) override { metrics_.CountMessage(sent, bytes); }
  void CountSkippedFrames(std::size_t frames) override { metrics_.CountSkippedFrames(frames); }

 private:
  void Listen() {
    try {
      const tcp::endpoint endpoint(asio::ip::make_address(options_.address),
                                   static_cast<std::uint16_t>(options_.port));
      acceptor_.open(endpoint.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(endpoint);
      acceptor_.listen();
      port_ = acceptor_.local_endpoint().port();
    } catch (const boost::system::system_error& error) {
      throw StartupError(fmt::format("console: cannot listen on {}:{}: {}", options_.address,
                                     options_.port, error.code().message()));
    }
  }

  void Accept() {
    acceptor_.async_accept([this](ErrorCodeOfAsio failed, tcp::socket socket) {
      if (leaving_) return;
      if (failed) return AcceptLater();
      Begin(std::move(socket));
      Accept();
    });
  }

  /// Out of file descriptors, for example: an immediate retry would only use the processor.
  void AcceptLater() {
    accept_timer_.expires_after(kAcceptPause);
    accept_timer_.async_wait([this](ErrorCodeOfAsio) {
      if (!leaving_) Accept();
    });
  }

  void Begin(tcp::socket socket) {
    if (connections_ >= options_.max_connections) {  // closes it
      return Note(
          fmt::format("{} connections are open, the limit of "
                      "operator.console.max_connections",
                      connections_));
    }
    ErrorCodeOfAsio ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    metrics_.SetConnections(++connections_);
    const std::shared_ptr<void> token(nullptr,
                                      [this](void*) { metrics_.SetConnections(--connections_); });
    if (tls_) {
      std::make_shared<HttpConnection<TlsStream>>(TlsStream(std::move(socket), *tls_), *this, token)
          ->Start();
    } else {
      std::make_shared<HttpConnection<PlainStream>>(PlainStream(std::move(socket)), *this, token)
          ->Start();
    }
  }

  std::vector<std::shared_ptr<PageConnection>> LivePages() const {
    std::vector<std::shared_ptr<PageConnection>> pages;
    for (const auto& [number, page] : pages_) pages.push_back(page);
    return pages;  // a page that leaves while it is pumped changes the map
  }

  int CountOf(bool (PageFeed::*is)() const) const {
    return static_cast<int>(std::count_if(pages_.begin(), pages_.end(), [is](const auto& page) {
      return (page.second->feed().*is)();
    }));
  }

  /// Pages say Hello at once: many silent connections must not keep others out.
  void CloseOldestNewPage() {
    const auto oldest = std::find_if(pages_.begin(), pages_.end(),
                                     [](const auto& page) { return page.second->feed().is_new(); });
    const auto page = oldest->second;
    page->feed().Close("no Hello arrived, and other pages wait", true);
    page->Pump();
  }

  void CountPages() { metrics_.SetPages(static_cast<int>(pages_.size())); }

  void Note(const std::string& why) {
    metrics_.CountRefusedPage();
    if (const auto held_back = refusals_logged_.Allow()) {
      LOG_WARNING("page of the console refused", "reason", why, "held_back", *held_back);
    }
  }

  void SayGoodbye() {
    leaving_ = true;
    ErrorCodeOfAsio ignored;
    acceptor_.close(ignored);
    if (pages_.empty()) return io_.stop();
    for (const auto& page : LivePages()) {
      page->feed().End("the service stops");
      page->Pump();
    }
    goodbye_timer_.expires_after(kGoodbyeLimit);
    goodbye_timer_.async_wait([this](ErrorCodeOfAsio) { io_.stop(); });
  }

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
  std::optional<asio::ssl::context> tls_;
  GatewayMetrics metrics_;
  HttpRoutes routes_;
  int connections_ = 0;  // outlive io_, whose handlers hold the connections and pages
  std::atomic<bool> notified_{false};
  LogLimit refusals_logged_;
  mutable std::mutex mutex_;  // guards the four below
  std::vector<PageEvent> events_;
  std::size_t waiting_bytes_ = 0;  // of them
  Readiness readiness_;
  Clock::TimePoint readiness_set_at_ = Clock::TimePoint::clock::now();
  std::map<std::uint64_t, std::shared_ptr<PageConnection>> pages_;
  std::uint64_t last_page_ = 0;
  bool leaving_ = false;
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer accept_timer_{io_};
  asio::steady_timer goodbye_timer_{io_};
  int port_ = 0;
  std::thread thread_;
};

Gateway::Gateway(const GatewayOptions& options, Shared shared, console::Welcome welcome,
                 std::function<void()> wake)
    : server_(std::make_unique<Server>(options, shared, std::move(welcome), std::move(wake))) {}

Gateway::~Gateway() = default;

int Gateway::port() const { return server_->port(); }

std::string Gateway::url() const {
  const std::string& address = server_->options().address;
  const bool is_v6 = address.find(':') != std::string::npos;
  return fmt::format("{}://{}{}{}:{}", server_->has_tls() ? "https" : "http", is_v6 ? "[" : "",
                     address, is_v6 ? "]" : "", server_->port());
}

void Gateway::Notify() { server_->Notify(); }
std::vector<PageEvent> Gateway::Take() { return server_->Take(); }
void Gateway::Send(std::uint64_t page, const console::Reply& reply) { server_->Send(page, reply); }
void Gateway::SetReadiness(Readiness readiness) { server_->SetReadiness(std::move(readiness)); }

}  // namespace conav::operators
