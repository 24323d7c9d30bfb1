#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "operator/gateway/http_routes.h"
#include "operator/gateway/page_feed.h"

/// What the gateway's connections have in common. This header, http_connection.h and websocket_page.h
/// are parts of gateway.cc only, the one translation unit with Boost.Beast. Everything in them runs on
/// the gateway's thread. A connection lives as long as an operation on it is under way.
namespace conav::operators {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;
using ErrorCodeOfAsio = boost::system::error_code;
using PlainRequest = http::request<http::empty_body>;

/// A page's connection, whatever it runs over.
class PageConnection {
 public:
  virtual ~PageConnection() = default;
  /// There may be something to send.
  virtual void Pump() = 0;
  virtual PageFeed& feed() = 0;
};

/// What connections need of the server.
class ConnectionHost {
 public:
  virtual ~ConnectionHost() = default;
  virtual const GatewayOptions& options() const = 0;
  virtual HttpResponse Answer(const HttpRequest& request) = 0;
  /// To what is no request.
  virtual HttpResponse Refuse(unsigned status, const std::string& why) = 0;
  /// Why no page may be opened now; nothing = one may.
  virtual std::optional<HttpResponse> RefusePage(const HttpRequest& request) = 0;
  virtual PageContext page_context() = 0;
  virtual std::uint64_t Enter(const std::shared_ptr<PageConnection>& page) = 0;
  virtual void Leave(std::uint64_t page) = 0;
  /// False when too much waits for the service already: nothing was delivered.
  virtual bool Deliver(std::vector<PageEvent> events) = 0;
  virtual void CountMessage(bool sent, std::size_t bytes) = 0;
  virtual void CountSkippedFrames(std::size_t frames) = 0;
};

/// What a stream over TCP can do. A test specialises them for a stream in memory.
template <class Lowest>
void LimitTime(Lowest& layer, std::chrono::seconds limit) {
  layer.expires_after(limit);
}
template <class Lowest>
void LimitTimeNoLonger(Lowest& layer) {
  layer.expires_never();
}
template <class Lowest>
void EndSending(Lowest& layer) {
  ErrorCodeOfAsio ignored;
  layer.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
}

}  // namespace conav::operators
