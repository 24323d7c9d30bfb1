#include "operator/gateway/gateway_metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/text_serializer.h>

namespace conav::operators {
namespace {

prometheus::Gauge& AddGauge(prometheus::Registry& registry, const char* name, const char* help) {
  return prometheus::BuildGauge().Name(name).Help(help).Register(registry).Add({});
}

prometheus::Family<prometheus::Counter>& AddCounters(prometheus::Registry& registry,
                                                     const char* name, const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

}  // namespace

GatewayMetrics::GatewayMetrics()
    : pages_(AddGauge(registry_, "conav_console_pages", "Pages of the console that are connected")),
      connections_(AddGauge(registry_, "conav_console_connections", "Open TCP connections")),
      shown_bytes_(AddGauge(registry_, "conav_console_shown_bytes",
                            "What a new page is sent, without pictures and live views")),
      messages_in_(AddCounters(registry_, "conav_console_received_messages_total",
                               "WebSocket messages from pages")
                       .Add({})),
      messages_out_(
          AddCounters(registry_, "conav_console_sent_messages_total", "WebSocket messages to pages")
              .Add({})),
      bytes_in_(
          AddCounters(registry_, "conav_console_received_bytes_total", "Their payload").Add({})),
      bytes_out_(AddCounters(registry_, "conav_console_sent_bytes_total", "Their payload").Add({})),
      skipped_frames_(AddCounters(registry_, "conav_console_skipped_frames_total",
                                  "Frames of streams that pages were too slow for")
                          .Add({})),
      refused_pages_(AddCounters(registry_, "conav_console_refused_pages_total",
                                 "Pages that were refused or closed for what they sent")
                         .Add({})),
      requests_(AddCounters(registry_, "conav_console_http_requests_total",
                            "HTTP requests, by status")) {}

void GatewayMetrics::SetPages(int pages) { pages_.Set(pages); }
void GatewayMetrics::SetConnections(int connections) { connections_.Set(connections); }

void GatewayMetrics::SetShownBytes(std::size_t bytes) {
  shown_bytes_.Set(static_cast<double>(bytes));
}

void GatewayMetrics::CountRequest(unsigned status) {
  requests_.Add({{"status", std::to_string(status)}}).Increment();
}

void GatewayMetrics::CountMessage(bool sent, std::size_t bytes) {
  (sent ? messages_out_ : messages_in_).Increment();
  (sent ? bytes_out_ : bytes_in_).Increment(static_cast<double>(bytes));
}

void GatewayMetrics::CountSkippedFrames(std::size_t frames) {
  skipped_frames_.Increment(static_cast<double>(frames));
}

void GatewayMetrics::CountRefusedPage() { refused_pages_.Increment(); }

std::string GatewayMetrics::Text() const {
  return prometheus::TextSerializer().Serialize(registry_.Collect());
}

}  // namespace conav::operators
