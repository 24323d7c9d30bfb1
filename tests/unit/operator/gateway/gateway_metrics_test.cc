#include <fmt/core.h>

#include <catch2/catch.hpp>

#include "operator/gateway/gateway.h"

namespace conav::operators {

TEST_CASE("each event is counted, from 0 on", "[operator][gateway]") {
  GatewayMetrics metrics;
  for (const char* name : {"pages", "connections", "received_messages_total", "sent_bytes_total",
                           "refused_pages_total"}) {
    CHECK_THAT(metrics.Text(), Catch::Contains(fmt::format("conav_console_{} 0", name)));
  }
  metrics.SetPages(2);
  metrics.SetConnections(3);
  metrics.SetShownBytes(700);
  metrics.CountMessage(true, 10);
  metrics.CountMessage(true, 5);
  metrics.CountMessage(false, 4);
  metrics.CountSkippedFrames(6);
  metrics.CountRefusedPage();
  metrics.CountRequest(200);
  metrics.CountRequest(404);
  metrics.CountRequest(404);
  const std::string text = metrics.Text();
  for (const char* line :
       {"conav_console_pages 2", "conav_console_connections 3", "conav_console_shown_bytes 700",
        "conav_console_sent_messages_total 2", "conav_console_sent_bytes_total 15",
        "conav_console_received_messages_total 1", "conav_console_received_bytes_total 4",
        "conav_console_skipped_frames_total 6", "conav_console_refused_pages_total 1",
        "conav_console_http_requests_total{status=\"200\"} 1",
        "conav_console_http_requests_total{status=\"404\"} 2"}) {
    CHECK_THAT(text, Catch::Contains(line));
  }
}

}  // namespace conav::operators
