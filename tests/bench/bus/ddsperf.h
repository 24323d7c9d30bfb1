#pragma once

#include <cstddef>
#include <optional>

#include "bench/bus/traffic.h"

namespace conav::bench {

/// Round trip of Cyclone's own ddsperf with the bus's configuration; its ping prints half of it,
/// which is doubled here. Nothing when ddsperf is not installed.
std::optional<RoundTrips> MeasureDdsperf(std::size_t size, int domain_id);

}  // namespace conav::bench
