#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "operator/console/update_log.h"
#include "operator/gateway/frame_slots.h"
#include "operator/gateway/gateway_options.h"
#include "operator/gateway/http_routes.h"
#include "operator/gateway/page_event.h"
#include "operator/gateway/picture_shelf.h"

namespace conav::operators {

/// The console's door: HTTP for the page, a WebSocket for what it shows and asks (idl/console.proto).
/// No other server is needed, and nothing is loaded from elsewhere.
///
/// What pages show is read from `updates`, `frames` and `pictures`; call Notify() when something was
/// put there. What pages ask is taken by Take(), after `wake` was called.
/// Threads: one of its own; the public functions may be called from any.
class Gateway {
 public:
  struct Shared {
    UpdateLog& updates;
    FrameSlots& frames;
    PictureShelf& pictures;
  };

  /// Listens from now on. `shared` outlives it. A `welcome` without a run gets one of its own. `wake` is called on the gateway's thread, must be
  /// short, and may be empty.
  /// Throws StartupError: options that would let strangers in, a port that is taken, no page, no or
  /// a wrong certificate.
  Gateway(const GatewayOptions& options, Shared shared, console::Welcome welcome,
          std::function<void()> wake);
  /// Tells the pages that the service goes, and ends.
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  int port() const;
  /// "http://127.0.0.1:8080"
  std::string url() const;

  void Notify();
  std::vector<PageEvent> Take();
  /// To a request of `page`; nothing happens when it has left.
  void Send(std::uint64_t page, const console::Reply& reply);
  void SetReadiness(Readiness readiness);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace conav::operators
