#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/clock.h"
#include "operator/gateway/access.h"
#include "operator/gateway/http_routes.h"

/// A server for HTTP and WebSockets, whatever they carry: the console's (Gateway), and Foxglove's.
namespace conav::operators {

/// A message of a WebSocket.
struct SocketMessage {
  std::string bytes;
  /// Follows `bytes`; shared with other connections. May be null.
  std::shared_ptr<const std::vector<std::uint8_t>> payload;
  bool is_text = false;
};

/// What one WebSocket sends and takes, without its socket. Threads: the server's.
class SocketFeed {
 public:
  virtual ~SocketFeed() = default;
  /// A message of the client. It must not throw, whatever the bytes.
  virtual void Take(std::string_view bytes, bool is_text, Clock::TimePoint now) = 0;
  /// The next message to send, if there is one now. Asked again when one is sent, after Take, when
  /// `due`, and by WebServer::Pump.
  virtual std::optional<SocketMessage> Next(Clock::TimePoint now) = 0;
  /// When Next() may return something without new input.
  virtual std::optional<Clock::TimePoint> due() const { return std::nullopt; }
  /// True when everything was sent and the connection should close.
  virtual bool finished() const = 0;
  /// Whether the connection is worth more than a new one, where there are too many.
  virtual bool is_kept() const { return !finished(); }
  /// Whether the client is asked to come back.
  virtual bool retry() const = 0;
  /// The server stops: the feed is finished soon.
  virtual void End(std::string reason) = 0;
};

/// What a WebServer serves. Threads: the server's.
class SocketHost {
 public:
  virtual ~SocketHost() = default;
  virtual HttpResponse Answer(const HttpRequest& request) = 0;
  /// To what is no request.
  virtual HttpResponse Refuse(unsigned status, const std::string& why) = 0;
  /// Why no WebSocket may be opened now; nothing = one may.
  virtual std::optional<HttpResponse> RefuseSocket(const HttpRequest& request) = 0;
  /// The subprotocol to use, one of those that the request offers; empty = none.
  virtual std::string SelectProtocol(const HttpRequest& /*request*/) { return ""; }
  /// A WebSocket was opened. Numbers count from 1.
  virtual std::unique_ptr<SocketFeed> Open(std::uint64_t number, const HttpRequest& request) = 0;
  /// It has ended; its feed is destroyed soon after.
  virtual void Leave(std::uint64_t number) = 0;
  virtual void CountMessage(bool sent, std::size_t bytes) = 0;
  virtual void CountConnections(int connections) = 0;
  /// A connection was closed because there are too many, or was not allowed.
  virtual void NoteRefused(const std::string& why) = 0;
};

/// Listens, and serves connections on one thread of its own: limits on their number, size and
/// silence, and TLS, as in the options. A client that reads nothing for `idle_s` is closed, also if
/// it sends. Where there are too many, a new connection takes the place of one that says nothing:
/// first of an address with its full number, then of the address that has most.
class WebServer {
 public:
  /// Listens, but serves nothing before Start(). `host` outlives it; `section` names the options in
  /// messages: "operator.console". Throws StartupError: options that would let strangers in, a port
  /// that is taken, no or a wrong certificate.
  WebServer(const GatewayOptions& options, const std::string& section, SocketHost& host);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  void Start();
  /// Ends the feeds, gives them half a second to say so, and stops listening. Call it before the end
  /// of what the host's functions use.
  void Stop();
  /// "http://127.0.0.1:8080"
  std::string url() const;
  int port() const;

  /// Runs `task` on the server's thread, soon. Threads: any.
  void Post(std::function<void()> task);
  /// There may be something to send to that WebSocket, to all. Threads: the server's.
  void Pump(std::uint64_t number);
  void PumpAll();

 private:
  class Sockets;
  std::unique_ptr<Sockets> sockets_;
};

}  // namespace conav::operators
