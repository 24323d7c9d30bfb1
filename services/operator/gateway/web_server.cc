#include "operator/gateway/web_server.h"

#include <fmt/core.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <list>
#include <map>
#include <thread>

#include "common/runtime/result.h"
#include "operator/gateway/http_connection.h"

namespace conav::operators {
namespace {

using asio::ip::tcp;

constexpr std::chrono::milliseconds kGoodbyeLimit{500};
constexpr std::chrono::milliseconds kAcceptPause{100};

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

/// One visitor's: a network of 64 bits is one household or one machine.
std::string AddressOf(const asio::ip::address& address) {
  if (address.is_v4()) return address.to_string();
  auto bytes = address.to_v6();
  if (bytes.is_v4_mapped())
    return asio::ip::make_address_v4(asio::ip::v4_mapped, bytes).to_string();
  auto network = bytes.to_bytes();
  std::fill(network.begin() + 8, network.end(), std::uint8_t{0});
  return asio::ip::address_v6(network).to_string() + "/64";
}

GatewayOptions Checked(const GatewayOptions& options) {
  if (const auto valid = CheckAccess(options); !valid) throw StartupError(valid.error().text);
  return options;
}

}  // namespace

class WebServer::Sockets final : public ConnectionHost {
 public:
  Sockets(const GatewayOptions& options, const std::string& section, SocketHost& host)
      : options_(Checked(options)),
        section_(section),
        host_(host),
        tls_(MakeTls(options_.tls)),
        acceptor_(io_) {
    Listen();
    Accept();
  }

  ~Sockets() override { Stop(); }

  void Stop() {
    if (!thread_.joinable()) return;
    asio::post(io_, [this] { SayGoodbye(); });
    thread_.join();
    connections_.clear();  // while io_ exists, which their sockets belong to
  }

  void Start() {
    thread_ = std::thread([this] { io_.run(); });
  }

  int port() const { return port_; }
  bool has_tls() const { return tls_.has_value(); }
  const GatewayOptions& options() const override { return options_; }
  SocketHost& host() override { return host_; }

  void Post(std::function<void()> task) { asio::post(io_, std::move(task)); }

  void Pump(std::uint64_t number) {
    const auto found = connections_.find(number);
    if (found == connections_.end()) return;
    const auto connection = found->second;  // one that leaves while it is pumped changes the map
    connection->Pump();
  }

  void PumpAll() {
    for (const auto& connection : Live()) connection->Pump();
  }

  std::uint64_t Enter(const std::shared_ptr<SocketConnection>& connection) override {
    connections_[++last_number_] = connection;
    return last_number_;
  }

  void Leave(std::uint64_t number) override {
    if (connections_.erase(number) == 0) return;
    host_.Leave(number);
    if (leaving_ && connections_.empty()) io_.stop();
  }

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
      throw StartupError(fmt::format("{}: cannot listen on {}:{}: {}", section_, options_.address,
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
    ErrorCodeOfAsio ignored;
    const std::string address = AddressOf(socket.remote_endpoint(ignored).address());
    if (!MakeRoom(address)) {  // closes it
      return host_.NoteRefused(fmt::format(
          "{} connections are open, which pages need; another one came from {}: the limits "
          "are operator.console.max_connections and max_connections_per_address",
          open_.size(), address));
    }
    socket.set_option(tcp::no_delay(true), ignored);
    open_.push_back(new OpenConnection{address, OpenConnection::Stage::kMute, nullptr});
    const std::shared_ptr<OpenConnection> token(open_.back(), [this](OpenConnection* ended) {
      open_.remove(ended);
      delete ended;
      host_.CountConnections(static_cast<int>(open_.size()));
    });
    host_.CountConnections(static_cast<int>(open_.size()));
    if (tls_) {
      std::make_shared<HttpConnection<TlsStream>>(TlsStream(std::move(socket), *tls_), *this, token)
          ->Start();
    } else {
      std::make_shared<HttpConnection<PlainStream>>(PlainStream(std::move(socket)), *this, token)
          ->Start();
    }
  }

  /// Drops a connection where there are too many. False when all of them are kept.
  bool MakeRoom(const std::string& address) {
    std::map<std::string_view, int> counts;  // by address
    for (const OpenConnection* one : open_) ++counts[one->address];
    const bool is_full = counts[address] >= options_.max_connections_per_address;
    if (!is_full && static_cast<int>(open_.size()) < options_.max_connections) return true;
    const auto rank = [&](const OpenConnection* one) {
      return std::pair(-counts[one->address], one->stage);
    };
    OpenConnection* first = nullptr;  // the oldest of those with the lowest rank
    for (OpenConnection* one : open_) {
      if (one->stage == OpenConnection::Stage::kKept) continue;
      if (is_full && one->address != address) continue;
      if (first == nullptr || rank(one) < rank(first)) first = one;
    }
    if (first == nullptr) return false;
    open_.remove(first);
    first->drop();
    return true;
  }

  std::vector<std::shared_ptr<SocketConnection>> Live() const {
    std::vector<std::shared_ptr<SocketConnection>> live;
    for (const auto& [number, connection] : connections_) live.push_back(connection);
    return live;
  }

  void SayGoodbye() {
    leaving_ = true;
    ErrorCodeOfAsio ignored;
    acceptor_.close(ignored);
    if (connections_.empty()) return io_.stop();
    for (const auto& connection : Live()) {
      connection->feed().End("the service stops");
      connection->Pump();
    }
    goodbye_timer_.expires_after(kGoodbyeLimit);
    goodbye_timer_.async_wait([this](ErrorCodeOfAsio) { io_.stop(); });
  }

  const GatewayOptions options_;
  const std::string section_;
  SocketHost& host_;
  std::optional<asio::ssl::context> tls_;
  std::list<OpenConnection*> open_;  // oldest first; outlives io_, whose handlers hold them
  std::map<std::uint64_t, std::shared_ptr<SocketConnection>> connections_;  // WebSockets
  std::uint64_t last_number_ = 0;
  bool leaving_ = false;
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer accept_timer_{io_};
  asio::steady_timer goodbye_timer_{io_};
  int port_ = 0;
  std::thread thread_;
};

WebServer::WebServer(const GatewayOptions& options, const std::string& section, SocketHost& host)
    : sockets_(std::make_unique<Sockets>(options, section, host)) {}

WebServer::~WebServer() = default;

void WebServer::Start() { sockets_->Start(); }
void WebServer::Stop() { sockets_->Stop(); }
int WebServer::port() const { return sockets_->port(); }

std::string WebServer::url() const {
  const std::string& address = sockets_->options().address;
  const bool is_v6 = address.find(':') != std::string::npos;
  return fmt::format("{}://{}{}{}:{}", sockets_->has_tls() ? "https" : "http", is_v6 ? "[" : "",
                     address, is_v6 ? "]" : "", sockets_->port());
}

void WebServer::Post(std::function<void()> task) { sockets_->Post(std::move(task)); }
void WebServer::Pump(std::uint64_t number) { sockets_->Pump(number); }
void WebServer::PumpAll() { sockets_->PumpAll(); }

}  // namespace conav::operators
