#pragma once

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "operator/console/wall_seconds.h"
#include "operator/gateway/connection.h"

/// Part of gateway.cc only; see connection.h.
namespace conav::operators {

namespace websocket = boost::beast::websocket;

/// The WebSocket of one page: what its PageFeed says goes out, what comes in goes to it.
template <class Stream>
class WebSocketPage final : public PageConnection,
                            public std::enable_shared_from_this<WebSocketPage<Stream>> {
 public:
  /// `token` counts the connection, as in HttpConnection.
  WebSocketPage(Stream&& stream, ConnectionHost& host, std::shared_ptr<void> token)
      : host_(host),
        token_(std::move(token)),
        socket_(std::move(stream)),
        timer_(socket_.get_executor()) {}

  void Accept(const PlainRequest& upgrade) {
    LimitTimeNoLonger(beast::get_lowest_layer(socket_));
    const auto idle = std::chrono::duration_cast<std::chrono::milliseconds>(idle_limit());
    socket_.set_option(websocket::stream_base::timeout{std::chrono::seconds(10), idle, true});
    socket_.read_message_max(static_cast<std::size_t>(host_.options().max_message_kib) * 1024U);
    socket_.binary(true);
    socket_.async_accept(upgrade, [self = this->shared_from_this()](ErrorCodeOfAsio failed) {
      if (!failed) self->Enter();
    });
  }

  void Pump() override {
    if (writing_ || gone_) return;
    auto message = feed_->Next(Clock::TimePoint::clock::now());
    host_.CountSkippedFrames(feed_->TakeFramesSkipped());
    if (message) return Write(*std::move(message));
    if (feed_->finished()) return Close();
    if (const auto due = feed_->due()) At(*due, [this] { Pump(); });
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
    auto events = feed_->Take(bytes, Clock::TimePoint::clock::now(), WallSeconds());
    if (!host_.Deliver(std::move(events))) feed_->Close("the service does not keep up", true);
    incoming_.consume(incoming_.size());
    Pump();
    Read();
  }

  void Write(std::string message) {
    writing_ = true;
    outgoing_ = std::move(message);
    // A page that takes nothing for so long is gone, however much it sends.
    At(Clock::TimePoint::clock::now() + idle_limit(), [this] { Leave(); });
    socket_.async_write(asio::buffer(outgoing_),
                        [self = this->shared_from_this()](ErrorCodeOfAsio failed, std::size_t) {
                          self->writing_ = false;
                          self->timer_.cancel();
                          if (failed) return self->Leave();
                          self->host_.CountMessage(true, self->outgoing_.size());
                          self->Pump();
                        });
  }

  /// One at a time: whoever comes later replaces what waits.
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
    timer_.cancel();
    const auto code =
        feed_->retry() ? websocket::close_code::going_away : websocket::close_code::policy_error;
    socket_.async_close(code,
                        [self = this->shared_from_this()](ErrorCodeOfAsio) { self->Leave(); });
  }

  void Leave() {
    gone_ = true;
    timer_.cancel();
    beast::get_lowest_layer(socket_).close();
    if (std::exchange(number_, 0) != 0) host_.Leave(feed_->page());
  }

  ConnectionHost& host_;
  std::shared_ptr<void> token_;
  websocket::stream<Stream> socket_;
  asio::steady_timer timer_;
  std::optional<PageFeed> feed_;
  std::uint64_t number_ = 0;
  beast::flat_buffer incoming_;
  std::string outgoing_;
  bool writing_ = false;
  bool gone_ = false;
};

}  // namespace conav::operators
