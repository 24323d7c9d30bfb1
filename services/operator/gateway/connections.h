#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "operator/gateway/http_routes.h"
#include "operator/gateway/page_feed.h"

/// Parts of gateway.cc only, which is the one translation unit with Boost.Beast. Everything here runs
/// on the gateway's thread. A connection lives as long as an operation on it is under way.
namespace conav::operators {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

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
  /// Why no page may be opened now; empty = one may.
  virtual std::string WhyNoPage(const HttpRequest& request) = 0;
  virtual PageContext page_context() = 0;
  virtual std::uint64_t Enter(const std::shared_ptr<PageConnection>& page) = 0;
  virtual void Leave(std::uint64_t page) = 0;
  virtual void Deliver(std::vector<PageEvent> events) = 0;
  virtual void CountMessage(bool sent, std::size_t bytes) = 0;
};

inline double WallSeconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

template <class Stream>
class WebSocketPage final : public PageConnection,
                            public std::enable_shared_from_this<WebSocketPage<Stream>> {
 public:
  WebSocketPage(Stream&& stream, ConnectionHost& host)
      : host_(host), socket_(std::move(stream)), timer_(socket_.get_executor()) {}

  void Accept(const PlainRequest& upgrade) {
    beast::get_lowest_layer(socket_).expires_never();
    const auto idle = Seconds(host_.options().idle_s);
    socket_.set_option(websocket::stream_base::timeout{
        std::chrono::seconds(10), std::chrono::duration_cast<std::chrono::milliseconds>(idle),
        true});
    socket_.read_message_max(static_cast<std::size_t>(host_.options().max_message_kib) * 1024U);
    socket_.binary(true);
    socket_.async_accept(upgrade, [self = this->shared_from_this()](ErrorCodeOfAsio failed) {
      if (!failed) self->Enter();
    });
  }

  void Pump() override {
    if (writing_ || gone_) return;
    if (auto message = feed_->Next(Clock::TimePoint::clock::now()))
      return Write(*std::move(message));
    if (feed_->finished()) return Close();
    if (const auto due = feed_->due()) WaitUntil(*due);
  }

  PageFeed& feed() override { return *feed_; }

 private:
  void Enter() {
    number_ = host_.Enter(this->shared_from_this());
    feed_.emplace(host_.page_context(), number_, Clock::TimePoint::clock::now());
    Read();
    Pump();
  }

  void Read() {
    socket_.async_read(incoming_,
                       [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
                         self->TakeIn(failed);
                       });
  }

  void TakeIn(ErrorCodeOfAsio failed) {
    if (failed) return Leave();
    const std::string_view bytes(static_cast<const char*>(incoming_.data().data()),
                                 incoming_.size());
    host_.CountMessage(false, bytes.size());
    host_.Deliver(feed_->Take(bytes, Clock::TimePoint::clock::now(), WallSeconds()));
    incoming_.consume(incoming_.size());
    Pump();
    Read();
  }

  void Write(std::string message) {
    writing_ = true;
    outgoing_ = std::move(message);
    socket_.async_write(asio::buffer(outgoing_),
                        [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
                          self->writing_ = false;
                          if (failed) return self->Leave();
                          self->host_.CountMessage(true, self->outgoing_.size());
                          self->Pump();
                        });
  }

  void WaitUntil(Clock::TimePoint due) {
    timer_.expires_at(due);
    timer_.async_wait([self = this->shared_from_this()](ErrorCodeOfAsio cancelled) {
      if (!cancelled) self->Pump();
    });
  }

  void Close() {
    if (std::exchange(gone_, true)) return;
    timer_.cancel();
    socket_.async_close(websocket::close_code::policy_error,
                        [self = this->shared_from_this()](ErrorCodeOfAsio) { self->Leave(); });
  }

  void Leave() {
    gone_ = true;
    timer_.cancel();
    beast::get_lowest_layer(socket_).close();
    if (std::exchange(number_, 0) != 0) host_.Leave(feed_->page());
  }

  ConnectionHost& host_;
  websocket::stream<Stream> socket_;
  asio::steady_timer timer_;
  std::optional<PageFeed> feed_;
  std::uint64_t number_ = 0;
  beast::flat_buffer incoming_;
  std::string outgoing_;
  bool writing_ = false;
  bool gone_ = false;
};

template <class Stream>
class HttpConnection final : public std::enable_shared_from_this<HttpConnection<Stream>> {
 public:
  /// `over` runs when the connection has ended, or has become a page's.
  HttpConnection(Stream&& stream, ConnectionHost& host, std::shared_ptr<void> token)
      : host_(host), stream_(std::move(stream)), token_(std::move(token)) {}

  void Start() {
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      beast::get_lowest_layer(stream_).expires_after(kTimeLimit);
      stream_.async_handshake(asio::ssl::stream_base::server,
                              [self = this->shared_from_this()](ErrorCodeOfAsio failed) {
                                if (!failed) self->Read();
                              });
    } else {
      Read();
    }
  }

 private:
  static constexpr std::chrono::seconds kTimeLimit{30};
  static constexpr std::uint32_t kHeaderLimit = 16U * 1024U;

  void Read() {
    parser_.emplace();
    parser_->header_limit(kHeaderLimit);
    parser_->body_limit(0);
    beast::get_lowest_layer(stream_).expires_after(kTimeLimit);
    http::async_read(stream_, buffer_, *parser_,
                     [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
                       if (!failed) self->Handle();
                     });
  }

  static std::string Text(beast::string_view text) { return {text.data(), text.size()}; }

  HttpRequest Seen() const {
    const auto& request = parser_->get();
    return {Text(request.method_string()),
            Text(request.target()),
            Text(request[http::field::host]),
            Text(request[http::field::origin]),
            Text(request[http::field::authorization]),
            Text(request[http::field::accept_encoding]),
            Text(request[http::field::if_none_match])};
  }

  void Handle() {
    const HttpRequest request = Seen();
    if (!websocket::is_upgrade(parser_->get())) return Write(host_.Answer(request));
    const std::string refusal =
        request.target == "/ws" ? host_.WhyNoPage(request) : "pages connect to /ws";
    if (refusal.empty()) {
      const auto page = std::make_shared<WebSocketPage<Stream>>(std::move(stream_), host_);
      return page->Accept(parser_->release());
    }
    HttpResponse response;
    response.status = 403;
    response.body = std::make_shared<const std::string>(refusal + "\n");
    Write(std::move(response));
  }

  void Write(HttpResponse answer) {
    body_ = std::move(answer.body);
    const bool head = parser_->get().method() == http::verb::head;
    const std::size_t size = body_ ? body_->size() : 0;
    http::response<http::buffer_body> response;
    response.result(answer.status);
    response.version(parser_->get().version());
    response.keep_alive(parser_->get().keep_alive());
    response.set(http::field::content_type, answer.type);
    for (const auto& [name, value] : answer.headers) response.set(name, value);
    if (answer.status != 304) response.content_length(size);
    const bool sends_body = size > 0 && !head;
    response.body().data = sends_body ? const_cast<char*>(body_->data()) : nullptr;
    response.body().size = sends_body ? size : 0;
    response.body().more = false;
    response_ = std::move(response);
    serializer_.emplace(*response_);
    beast::get_lowest_layer(stream_).expires_after(kTimeLimit);
    if (head) {
      http::async_write_header(stream_, *serializer_, Written());
    } else {
      http::async_write(stream_, *serializer_, Written());
    }
  }

  auto Written() {
    return [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
      if (failed) return;
      if (self->response_->keep_alive()) return self->Read();
      ErrorCodeOfAsio ignored;
      beast::get_lowest_layer(self->stream_)
          .socket()
          .shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    };
  }

  ConnectionHost& host_;
  Stream stream_;
  std::shared_ptr<void> token_;  // counts this connection while it lives
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::shared_ptr<const std::string> body_;
  std::optional<http::response<http::buffer_body>> response_;
  std::optional<http::response_serializer<http::buffer_body>> serializer_;
};

}  // namespace conav::operators
