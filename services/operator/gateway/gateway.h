#pragma once

#include <prometheus/registry.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "operator/console/update_log.h"
#include "operator/gateway/access.h"
#include "operator/gateway/http_routes.h"
#include "operator/gateway/page_feed.h"
#include "operator/gateway/snapshot_store.h"

namespace prometheus {
class Counter;
class Gauge;
}  // namespace prometheus

namespace conav::operators {

/// Metrics of the gateway for Prometheus.
/// Threads: safe to call concurrently.
class GatewayMetrics {
 public:
  GatewayMetrics();

  void SetPages(int pages);
  void SetConnections(int connections);
  /// Of everything that a new page is sent.
  void SetShownBytes(std::size_t bytes);
  void CountRequest(unsigned status);
  void CountMessage(bool sent, std::size_t bytes);
  void CountSkippedFrames(std::size_t frames);
  void CountRefusedPage();
  std::string Text() const;

 private:
  prometheus::Registry registry_;
  prometheus::Gauge& pages_;
  prometheus::Gauge& connections_;
  prometheus::Gauge& shown_bytes_;
  prometheus::Counter& messages_in_;
  prometheus::Counter& messages_out_;
  prometheus::Counter& bytes_in_;
  prometheus::Counter& bytes_out_;
  prometheus::Counter& skipped_frames_;
  prometheus::Counter& refused_pages_;
  prometheus::Family<prometheus::Counter>& requests_;
};

/// The console's server: HTTP for the page, a WebSocket for what it shows and asks
/// (idl/console.proto). The page needs no other server.
///
/// Pages show `updates`, `frames` and `pictures`; call Notify() after a change there. Pages'
/// requests arrive through Take(), after `wake` was called.
/// Threads: one of its own; the public functions may be called from any.
class Gateway {
 public:
  struct Shared {
    UpdateLog& updates;
    FrameSlots& frames;
    SnapshotStore& snapshots;
  };

  /// Listens from now on. `shared` outlives it. A `welcome` without a run gets one of its own.
  /// `wake` is called on the gateway's thread, must be short, and may be empty. Throws
  /// StartupError: options that would let strangers in, a port that is taken, no page, no or a
  /// wrong certificate.
  Gateway(const GatewayOptions& options, Shared shared, console::Welcome welcome,
          std::function<void()> wake);
  /// Closes the pages ("the service stops") and stops listening.
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  int port() const;
  /// "http://127.0.0.1:8080"
  std::string url() const;

  void Notify();
  std::vector<PageEvent> Take();
  /// The reply to a request of `page`; ignored when the page has left.
  void Send(std::uint64_t page, const console::Reply& reply);
  void SetReadiness(Readiness readiness);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace conav::operators
