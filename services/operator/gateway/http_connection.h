#pragma once

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "operator/gateway/connection.h"
#include "operator/gateway/websocket_page.h"

/// Part of gateway.cc only; see connection.h.
namespace conav::operators {

/// Answers one request after the other, until one of them opens a page.
template <class Stream>
class HttpConnection final : public std::enable_shared_from_this<HttpConnection<Stream>> {
 public:
  /// `token` counts this connection while it lives.
  HttpConnection(Stream&& stream, ConnectionHost& host, std::shared_ptr<void> token)
      : host_(host), stream_(std::move(stream)), token_(std::move(token)) {}

  void Start() {
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
    Write(host_.Refuse(status, failed.message()), false);
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
    const bool keep_alive = parser_->get().keep_alive();
    if (!websocket::is_upgrade(parser_->get())) return Write(host_.Answer(request), keep_alive);
    if (auto refusal = host_.RefusePage(request)) return Write(*std::move(refusal), keep_alive);
    const auto page =
        std::make_shared<WebSocketPage<Stream>>(std::move(stream_), host_, std::move(token_));
    page->Accept(parser_->release());
  }

  void Write(HttpResponse answer, bool keep_alive) {
    body_ = std::move(answer.body);
    const bool head = parser_->get().method() == http::verb::head;
    const std::size_t size = body_ ? body_->size() : 0;
    http::response<http::buffer_body> response;
    response.result(answer.status);
    response.version(parser_->get().version());
    response.keep_alive(keep_alive);
    response.set(http::field::content_type, answer.type);
    for (const auto& [name, value] : answer.headers) response.set(name, value);
    if (answer.status != 304) response.content_length(size);
    const bool sends_body = size > 0 && !head;
    response.body().data = sends_body ? const_cast<char*>(body_->data()) : nullptr;
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
  std::shared_ptr<void> token_;  // counts this connection while it lives
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::shared_ptr<const std::string> body_;
  std::optional<http::response<http::buffer_body>> response_;
  std::optional<http::response_serializer<http::buffer_body>> serializer_;
};

}  // namespace conav::operators
