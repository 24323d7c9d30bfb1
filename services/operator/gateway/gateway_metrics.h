#pragma once

#include <prometheus/registry.h>

#include <cstddef>
#include <string>

namespace prometheus {
class Counter;
class Gauge;
}  // namespace prometheus

namespace conav::operators {

/// What the gateway counts, as Prometheus reads it.
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

}  // namespace conav::operators
