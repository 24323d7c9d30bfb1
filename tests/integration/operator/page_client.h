#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.pb.h"

/// What a browser does, without one. Everything that waits ends after ten seconds at the latest.
namespace conav::operators {

struct PageOptions {
  int port = 0;
  std::string target = "/ws";
  std::string host = "127.0.0.1";
  std::string origin;
  std::string certificate;  // PEM file that the service's must be; empty = plain
};

/// One WebSocket of a page. Reads only on request.
class PageClient {
 public:
  /// Connects; refused() says when that failed.
  explicit PageClient(const PageOptions& options);
  ~PageClient();
  PageClient(const PageClient&) = delete;
  PageClient& operator=(const PageClient&) = delete;

  /// Status of the answer to the upgrade that was not accepted, 1 when there was none; 0 = connected.
  unsigned refused() const;
  /// False when the connection has ended.
  bool Send(const console::ClientMessage& message);
  bool SendBytes(const std::string& bytes);
  /// The next message; nothing when none came in time, or when the connection has ended.
  std::optional<console::ServerMessage> Receive(
      std::chrono::milliseconds limit = std::chrono::seconds(10));
  bool ended() const;
  /// With which the service closed; 0 = it did not, or not properly.
  unsigned close_code() const;
  /// As a browser does when its page is closed.
  void Close();

 private:
  class Socket;
  template <class Stream>
  class SocketOver;
  std::unique_ptr<Socket> socket_;
};

struct HttpAnswer {
  unsigned status = 0;  // 0 = the connection ended without an answer
  std::map<std::string, std::string> headers;
  std::string body;
};

/// Sends `bytes` as they are over one connection and reads `answers` answers; `head`: those have no
/// body. Fewer come back when the connection ends before.
std::vector<HttpAnswer> AskRaw(int port, const std::string& bytes, std::size_t answers = 1,
                               bool head = false);
/// "GET target", with further header lines that end in "\r\n".
HttpAnswer Get(int port, const std::string& target, const std::string& headers = "");
/// One of the service's own figures (/metrics); nothing when it has none of that name.
std::optional<double> MetricOf(int port, const std::string& name);

}  // namespace conav::operators
