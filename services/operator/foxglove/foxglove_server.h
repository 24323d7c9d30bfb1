#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "operator/foxglove/client_feed.h"
#include "operator/foxglove/foxglove_messages.h"
#include "operator/gateway/access.h"

// One user: foxglove_topics, which knows the bus; the server does not.

namespace conav::foxglove {

/// What a client asks of the service.
struct ClientRequest {
  std::uint64_t client = 0;  // one connection
  /// As in OperatorRequest::client: "foxglove/0123456789abcdef".
  std::string name;
  console::Role role = console::ROLE_OBSERVER;
  Asked body;
};

/// The server for clients that speak Foxglove's protocol: Foxglove, Lichtblick, and programs.
///
/// A client connects with a token of the console, where such are set, as "?token=..." of the address
/// or as bearer token, and its role counts as a page's. Where an origin is sent it must be listed.
/// Threads: one of its own; the public functions may be called from any.
class FoxgloveServer {
 public:
  /// Listens from now on. `wake` is called on the server's thread when there is something to take,
  /// and must be short. Throws StartupError as WebServer does.
  FoxgloveServer(const operators::FoxgloveOptions& options,
                 const operators::GatewayOptions& console, Catalog catalog,
                 std::function<void()> wake);
  /// Closes the connections ("the service stops").
  ~FoxgloveServer();
  FoxgloveServer(const FoxgloveServer&) = delete;
  FoxgloveServer& operator=(const FoxgloveServer&) = delete;

  /// "ws://127.0.0.1:8765"
  std::string url() const;

  /// Channels that somebody subscribes to now.
  std::set<std::uint32_t> wanted() const;
  std::vector<ClientRequest> Take();
  /// An answer; ignored when the client has left.
  void Send(std::uint64_t client, std::string bytes, bool is_text);
  void SetGraph(std::string text);
  /// The service's time, which clients are sent, and which messages get from now on. It goes back
  /// by more than kNearNs only.
  void SetTime(std::uint64_t time_ns);
  /// To those that subscribe to it. A stamp near the service's time is the message's time, and may
  /// be ahead of it; of others (wall time, a map from long ago) it is that of its arrival.
  void Put(std::uint32_t channel, std::vector<std::uint8_t> payload,
           std::optional<std::uint64_t> stamp_ns);
  static constexpr std::uint64_t kNearNs = 2'000'000'000;
  /// Messages of this channel that were put before are not kept for late subscribers any longer.
  void Forget(std::uint32_t channel);

  struct Figures {
    int clients = 0;
    std::uint64_t sent = 0;     // messages
    std::uint64_t skipped = 0;  // for clients that were too slow
    std::uint64_t dropped = 0;  // because the server was too slow
  };
  Figures figures() const;

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace conav::foxglove
