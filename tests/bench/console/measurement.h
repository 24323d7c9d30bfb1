#pragma once

#include <vector>

#include "bench/console/bare_client.h"
#include "bench/console/browsers.h"
#include "bench/console/console_service.h"
#include "bench/console/load.h"

namespace conav::bench {

/// Ages in ms.
struct Quantiles {
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

/// All 0 of no values.
Quantiles QuantilesOf(std::vector<double> values);

/// What was seen in one while. "Cores": s of processor time per s.
struct Round {
  Quantiles shown;                 // all pages together
  double worst_page_p95_ms = 0.0;  // of the page that has it worst
  Quantiles drawn;
  Quantiles any;
  Quantiles bare;  // of the bare client
  double frames_per_s = 0.0;
  double states_per_s = 0.0;  // of one robot, that a page showed
  double service_cores = 0.0;
  double service_mb = 0.0;        // at its end
  double service_grown_mb = 0.0;  // from its beginning to its end
  double browser_cores = 0.0;     // all browsers
  double load_cores = 0.0;
  double bare_cores = 0.0;
  double connection_kb_per_s = 0.0;  // to one page or the bare client by WebSocket, on average
  double lateness_ms = 0.0;          // of the load, at most
};

/// Everything that takes part.
struct Stage {
  Load& load;
  ConsoleService& service;
  BareClient& bare;
  Browsers& browsers;
};

/// Lets `seconds` pass and tells what happened in them. `connections`: pages and bare client that
/// take what they are sent.
Round MeasureRound(Stage& stage, double seconds, int connections);

}  // namespace conav::bench
