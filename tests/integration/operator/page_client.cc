#include "integration/operator/page_client.h"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <sstream>

#include "common/runtime/result.h"

namespace conav::operators {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using Failure = boost::system::error_code;

constexpr std::chrono::seconds kLimit{10};

asio::ip::tcp::endpoint At(int port) {
  return {asio::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(port)};
}

std::string Text(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace

class PageClient::Socket {
 public:
  virtual ~Socket() = default;
  virtual void Connect(const PageOptions& options) = 0;
  virtual void Write(const std::string& bytes) = 0;
  virtual bool Read(std::chrono::milliseconds limit) = 0;
  virtual void Close() = 0;

  unsigned refused = 0;
  bool ended = false;
  unsigned close_code = 0;
  std::string message;

 protected:
  /// Runs what was begun with Done(); false when the limit has passed.
  bool Finish(std::chrono::milliseconds limit = kLimit) {
    io_.restart();
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!done_ && io_.run_one_until(deadline) > 0) {
    }
    return done_;
  }
  auto Done() {
    done_ = false;
    return [this](Failure failed, auto...) {
      failed_ = failed;
      done_ = true;
    };
  }

  asio::io_context io_;
  Failure failed_;
  bool done_ = true;
};

template <class Stream>
class PageClient::SocketOver final : public Socket {
 public:
  SocketOver() : socket_(io_) {}
  explicit SocketOver(const std::string& certificate)
      : tls_(asio::ssl::context::tls_client), socket_(io_, tls_) {
    tls_.load_verify_file(certificate);
    tls_.set_verify_mode(asio::ssl::verify_peer);
  }
  ~SocketOver() override {
    beast::get_lowest_layer(socket_).close();
    io_.restart();
    io_.poll();  // what was under way ends
  }

  void Connect(const PageOptions& options) override {
    beast::get_lowest_layer(socket_).async_connect(At(options.port), Done());
    bool good = Finish() && !failed_;
    if constexpr (!std::is_same_v<Stream, beast::tcp_stream>) {
      if (good) {
        socket_.next_layer().async_handshake(asio::ssl::stream_base::client, Done());
        good = Finish() && !failed_;
      }
    }
    socket_.binary(true);
    socket_.read_message_max(0);
    socket_.set_option(websocket::stream_base::decorator([origin = options.origin](auto& request) {
      if (!origin.empty()) request.set(http::field::origin, origin);
    }));
    websocket::response_type answer;
    if (good) socket_.async_handshake(answer, options.host, options.target, Done());
    if (good && Finish() && !failed_) return;
    ended = true;
    refused = answer.result_int() == 200 ? 1 : answer.result_int();
  }

  void Write(const std::string& bytes) override {
    if (ended) return;
    socket_.async_write(asio::buffer(bytes), Done());
    if (!Finish() || failed_) End();
  }

  bool Read(std::chrono::milliseconds limit) override {
    if (ended) return false;
    if (!reading_) {
      reading_ = true;
      socket_.async_read(incoming_, [this](Failure failed, std::size_t) {
        reading_ = false;
        read_failed_ = failed;
      });
    }
    io_.restart();
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (reading_ && io_.run_one_until(deadline) > 0) {
    }
    if (reading_) return false;
    if (read_failed_) {
      End();
      return false;
    }
    message = beast::buffers_to_string(incoming_.data());
    incoming_.consume(incoming_.size());
    return true;
  }

  void Close() override {
    if (ended) return;
    socket_.async_close(websocket::close_code::normal, Done());
    Finish();
    End();
  }

 private:
  void End() {
    ended = true;
    close_code = socket_.reason().code;
  }

  asio::ssl::context tls_{asio::ssl::context::tls_client};
  websocket::stream<Stream> socket_;
  beast::flat_buffer incoming_;
  bool reading_ = false;
  Failure read_failed_;
};

PageClient::PageClient(const PageOptions& options) {
  if (options.certificate.empty()) {
    socket_ = std::make_unique<SocketOver<beast::tcp_stream>>();
  } else {
    socket_ =
        std::make_unique<SocketOver<beast::ssl_stream<beast::tcp_stream>>>(options.certificate);
  }
  socket_->Connect(options);
}

PageClient::~PageClient() = default;

unsigned PageClient::refused() const { return socket_->refused; }
bool PageClient::ended() const { return socket_->ended; }
unsigned PageClient::close_code() const { return socket_->close_code; }
void PageClient::Close() { socket_->Close(); }

bool PageClient::Send(const console::ClientMessage& message) {
  return SendBytes(message.SerializeAsString());
}

bool PageClient::SendBytes(const std::string& bytes) {
  socket_->Write(bytes);
  return !socket_->ended;
}

std::optional<console::ServerMessage> PageClient::Receive(std::chrono::milliseconds limit) {
  if (!socket_->Read(limit)) return std::nullopt;
  console::ServerMessage message;
  DEMAND(message.ParseFromString(socket_->message), socket_->message.size());
  return message;
}

std::vector<HttpAnswer> AskRaw(int port, const std::string& bytes, std::size_t answers, bool head) {
  asio::io_context io;
  beast::tcp_stream stream(io);
  stream.socket().connect(At(port));
  Failure failed;
  asio::write(stream.socket(), asio::buffer(bytes), failed);
  beast::flat_buffer buffer;
  std::vector<HttpAnswer> all;
  while (all.size() < answers) {
    http::response_parser<http::string_body> parser;
    parser.skip(head);
    stream.expires_after(kLimit);
    http::async_read(stream, buffer, parser, [&](Failure error, std::size_t) { failed = error; });
    io.restart();
    io.run();
    if (failed) break;
    HttpAnswer answer{parser.get().result_int(), {}, parser.get().body()};
    for (const auto& field : parser.get()) {
      answer.headers[Text(field.name_string())] = Text(field.value());
    }
    all.push_back(std::move(answer));
  }
  return all;
}

HttpAnswer Get(int port, const std::string& target, const std::string& headers) {
  const auto answers =
      AskRaw(port, "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" + headers + "\r\n");
  return answers.empty() ? HttpAnswer() : answers.front();
}

std::optional<double> MetricOf(int port, const std::string& name) {
  std::istringstream lines(Get(port, "/metrics").body);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(name + " ")) return std::stod(line.substr(name.size()));
  }
  return std::nullopt;
}

}  // namespace conav::operators
