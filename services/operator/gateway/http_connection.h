#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/runtime/clock.h"
#include "operator/gateway/http_routes.h"
#include "operator/gateway/web_server.h"

// One user: web_server.cc, the one translation unit of Boost.Beast; and a fuzz test.

/// The connections of a WebServer. Everything here runs on the server's thread. A connection lives
/// as long as an operation on it is under way.
namespace conav::operators {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;
using ErrorCodeOfAsio = boost::system::error_code;
using PlainRequest = http::request<http::empty_body>;

/// A WebSocket, whatever it runs over.
class SocketConnection {
 public:
  virtual ~SocketConnection() = default;
  /// There may be something to send.
  virtual void Pump() = 0;
  virtual SocketFeed& feed() = 0;
};

/// A connection as the server counts it. Where there are too many, the server drops the first of the
/// lowest stage for a new one.
struct OpenConnection {
  enum class Stage {
    kMute,  // without a request
    kIdle,  // between two requests
    kBusy,  // is answered, or a WebSocket whose feed does not need it
    kKept   // never dropped
  };

  std::string address;
  Stage stage = Stage::kMute;
  std::function<void()> drop;
};

/// What connections need of the server.
class ConnectionHost {
 public:
  virtual ~ConnectionHost() = default;
  virtual const GatewayOptions& options() const = 0;
  virtual SocketHost& host() = 0;
  /// Gives the connection its number.
  virtual std::uint64_t Enter(const std::shared_ptr<SocketConnection>& connection) = 0;
  virtual void Leave(std::uint64_t number) = 0;
};

/// How long closing a WebSocket may take, and what a stream over TCP can do. A test specialises them for a stream in memory.
template <class Lowest>
constexpr std::chrono::milliseconds kCloseLimit{2000};
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

namespace websocket = boost::beast::websocket;

/// One WebSocket: sends the messages of its feed, which gets those that arrive.
template <class Stream>
class WebSocketConnection final : public SocketConnection,
                                  public std::enable_shared_from_this<WebSocketConnection<Stream>> {
 public:
  /// `counted` as in HttpConnection.
  WebSocketConnection(Stream&& stream, ConnectionHost& host,
                      std::shared_ptr<OpenConnection> counted)
      : host_(host),
        counted_(std::move(counted)),
        socket_(std::in_place, std::move(stream)),
        timer_(socket_->get_executor()) {}

  void Accept(const PlainRequest& upgrade, HttpRequest request) {
    request_ = std::move(request);
    counted_->drop = [self = this->weak_from_this()] {
      if (const auto live = self.lock()) live->Leave();
    };
    LimitTimeNoLonger(beast::get_lowest_layer(*socket_));
    const auto idle = std::chrono::duration_cast<std::chrono::milliseconds>(idle_limit());
    socket_->set_option(websocket::stream_base::timeout{std::chrono::seconds(10), idle, true});
    socket_->read_message_max(static_cast<std::size_t>(host_.options().max_message_kib) * 1024U);
    const std::string protocol = host_.host().SelectProtocol(request_);
    if (!protocol.empty()) {
      socket_->set_option(
          websocket::stream_base::decorator([protocol](websocket::response_type& response) {
            response.set(http::field::sec_websocket_protocol, protocol);
          }));
    }
    socket_->async_accept(upgrade, [self = this->shared_from_this()](ErrorCodeOfAsio failed) {
      if (!failed) self->Enter();
    });
  }

  void Pump() override {
    if (writing_ || gone_) return;
    auto message = feed_->Next(Clock::TimePoint::clock::now());
    using Stage = OpenConnection::Stage;
    counted_->stage = feed_->is_kept() ? Stage::kKept : Stage::kBusy;
    if (message) return Write(*std::move(message));
    if (feed_->finished()) return Close();
    if (const auto due = feed_->due()) At(*due, [this] { Pump(); });
  }

  SocketFeed& feed() override { return *feed_; }

 private:
  void Enter() {
    if (gone_) return;
    number_ = host_.Enter(this->shared_from_this());
    feed_ = host_.host().Open(number_, request_);
    Read();
    Pump();
  }

  void Read() {
    socket_->async_read(incoming_,
                        [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
                          self->TakeIn(failed);
                        });
  }

  void TakeIn(ErrorCodeOfAsio failed) {
    if (failed) return Leave();
    const std::string_view bytes(static_cast<const char*>(incoming_.data().data()),
                                 incoming_.size());
    host_.host().CountMessage(false, bytes.size());
    feed_->Take(bytes, socket_->got_text(), Clock::TimePoint::clock::now());
    incoming_.consume(incoming_.size());
    Pump();
    if (!gone_) Read();  // what comes after Close() the closing itself reads
  }

  void Write(SocketMessage message) {
    writing_ = true;
    outgoing_ = std::move(message);
    // A client that reads nothing for so long is gone, even if it sends.
    At(Clock::TimePoint::clock::now() + idle_limit(), [this] { Leave(); });
    socket_->text(outgoing_.is_text);
    const auto& payload = outgoing_.payload;
    const std::array<asio::const_buffer, 2> buffers{
        asio::buffer(outgoing_.bytes), payload ? asio::buffer(*payload) : asio::const_buffer()};
    socket_->async_write(
        buffers, [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t sent) {
          self->writing_ = false;
          self->timer_.cancel();
          if (failed) return self->Leave();
          self->host_.host().CountMessage(true, sent);
          self->Pump();
        });
  }

  /// One timer: a later call replaces the earlier one.
  template <class Act>
  void At(Clock::TimePoint due, Act act) {
    timer_.expires_at(due);
    timer_.async_wait([self = this->shared_from_this(), act](ErrorCodeOfAsio cancelled) {
      const bool replaced = self->timer_.expiry() > Clock::TimePoint::clock::now();
      if (!cancelled && !replaced) act();
    });
  }

  std::chrono::nanoseconds idle_limit() const { return Seconds(host_.options().idle_s); }

  void Close() {
    if (std::exchange(gone_, true)) return;
    // In Beast a reading that finds an error while the close frame is under way waits for the
    // closing, which waits for the reading: without the stream both end. All others end first, since
    // some use the stream until then.
    static constexpr auto kLimit = kCloseLimit<beast::lowest_layer_type<Stream>>;
    At(Clock::TimePoint::clock::now() + kLimit, [this] {
      Leave();
      At(Clock::TimePoint::clock::now() + kLimit / 2, [this] { socket_.reset(); });
    });
    const auto code =
        feed_->retry() ? websocket::close_code::going_away : websocket::close_code::policy_error;
    socket_->async_close(code, [self = this->shared_from_this()](ErrorCodeOfAsio) {
      self->timer_.cancel();
      self->Leave();
    });
  }

  void Leave() {
    if (!std::exchange(gone_, true)) timer_.cancel();
    if (socket_) beast::get_lowest_layer(*socket_).close();
    if (const auto number = std::exchange(number_, 0); number != 0) host_.Leave(number);
  }

  ConnectionHost& host_;
  std::shared_ptr<OpenConnection> counted_;
  std::optional<websocket::stream<Stream>> socket_;
  asio::steady_timer timer_;
  HttpRequest request_;
  std::unique_ptr<SocketFeed> feed_;
  std::uint64_t number_ = 0;
  beast::flat_buffer incoming_;
  SocketMessage outgoing_;
  bool writing_ = false;
  bool gone_ = false;
};

/// Answers one request after the other, until one of them opens a WebSocket.
template <class Stream>
class HttpConnection final : public std::enable_shared_from_this<HttpConnection<Stream>> {
 public:
  /// `counted` counts this connection while it lives.
  HttpConnection(Stream&& stream, ConnectionHost& host, std::shared_ptr<OpenConnection> counted)
      : host_(host), stream_(std::move(stream)), counted_(std::move(counted)) {}

  void Start() {
    counted_->drop = [self = this->weak_from_this()] {
      if (const auto live = self.lock()) beast::get_lowest_layer(live->stream_).close();
    };
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      LimitTime(beast::get_lowest_layer(stream_), kTimeLimit);
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
  static constexpr std::chrono::seconds kEndLimit{2};
  static constexpr std::size_t kDrainBytes = 4096;
  static constexpr std::uint32_t kHeaderLimit = 16U * 1024U;

  void Read() {
    parser_.emplace();
    parser_->header_limit(kHeaderLimit);
    parser_->body_limit(0);
    LimitTime(beast::get_lowest_layer(stream_), kTimeLimit);
    // The head only: nothing here takes a body, and Beast of Boost 1.74 may abort on one that comes
    // in chunks and in pieces.
    http::async_read_header(stream_, buffer_, *parser_,
                            [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
                              if (!failed && !self->parser_->is_done()) {
                                failed = http::error::unexpected_body;
                              }
                              failed ? self->Complain(failed) : self->Handle();
                            });
  }

  /// Says what is wrong with a request to a client that is still there.
  void Complain(ErrorCodeOfAsio failed) {
    static const auto& http_errors = http::make_error_code(http::error::bad_method).category();
    const bool ended = failed == http::error::end_of_stream ||
                       failed == http::error::partial_message || failed.category() != http_errors;
    if (ended) return;
    const bool has_body =
        failed == http::error::body_limit || failed == http::error::unexpected_body;
    const unsigned status = has_body ? 413 : failed == http::error::header_limit ? 431 : 400;
    Write(host_.host().Refuse(status, failed.message()), false);
  }

  static std::string Text(beast::string_view text) { return {text.data(), text.size()}; }

  /// Of all headers of that name.
  std::string Protocols() const {
    std::string protocols;
    const auto [first, last] = parser_->get().equal_range(http::field::sec_websocket_protocol);
    for (auto header = first; header != last; ++header) {
      protocols += (protocols.empty() ? "" : ",") + Text(header->value());
    }
    return protocols;
  }

  HttpRequest Seen() const {
    const auto& request = parser_->get();
    return {Text(request.method_string()),
            Text(request.target()),
            Text(request[http::field::host]),
            Text(request[http::field::origin]),
            Text(request[http::field::authorization]),
            Text(request[http::field::accept_encoding]),
            Text(request[http::field::if_none_match]),
            Protocols(),
            counted_->address};
  }

  void Handle() {
    counted_->stage = OpenConnection::Stage::kBusy;
    const HttpRequest request = Seen();
    const bool keep_alive = parser_->get().keep_alive();
    if (!websocket::is_upgrade(parser_->get()))
      return Write(host_.host().Answer(request), keep_alive);
    if (auto refusal = host_.host().RefuseSocket(request))
      return Write(*std::move(refusal), keep_alive);
    const auto socket = std::make_shared<WebSocketConnection<Stream>>(std::move(stream_), host_,
                                                                      std::move(counted_));
    socket->Accept(parser_->release(), request);
  }

  void Write(HttpResponse answer, bool keep_alive) {
    body_ = std::move(answer.body);
    const bool head = parser_->get().method() == http::verb::head;
    const std::size_t size = body_.bytes.size();
    http::response<http::buffer_body> response;
    response.result(answer.status);
    response.version(parser_->get().version());
    response.keep_alive(keep_alive);
    response.set(http::field::content_type, answer.type);
    for (const auto& [name, value] : answer.headers) response.set(name, value);
    if (answer.status != 304) response.content_length(size);
    const bool sends_body = size > 0 && !head;
    response.body().data = sends_body ? const_cast<char*>(body_.bytes.data()) : nullptr;
    response.body().size = sends_body ? size : 0;
    response.body().more = false;
    response_ = std::move(response);
    serializer_.emplace(*response_);
    LimitTime(beast::get_lowest_layer(stream_), kTimeLimit);
    if (head) {
      http::async_write_header(stream_, *serializer_, Written());
    } else {
      http::async_write(stream_, *serializer_, Written());
    }
  }

  auto Written() {
    return [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
      if (failed) return;
      self->counted_->stage = OpenConnection::Stage::kIdle;
      self->response_->keep_alive() ? self->Read() : self->End();
    };
  }

  void End() {
    LimitTime(beast::get_lowest_layer(stream_), kEndLimit);
    if constexpr (std::is_same_v<Stream, TlsStream>) {
      stream_.async_shutdown([self = this->shared_from_this()](ErrorCodeOfAsio) {});
    } else {
      EndSending(beast::get_lowest_layer(stream_));
      Drain();
    }
  }

  /// Closed with bytes unread, the connection would be reset, and the answer with it.
  void Drain() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kDrainBytes),
                            [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
                              if (!failed) self->Drain();
                            });
  }

  ConnectionHost& host_;
  Stream stream_;
  std::shared_ptr<OpenConnection> counted_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  HttpBody body_;
  std::optional<http::response<http::buffer_body>> response_;
  std::optional<http::response_serializer<http::buffer_body>> serializer_;
};

}  // namespace conav::operators
