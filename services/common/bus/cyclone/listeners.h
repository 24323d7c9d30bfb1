#pragma once

#include <dds/dds.h>

#include <memory>

#include "common/bus/endpoint_events.h"

namespace conav::bus {

class CycloneReader;

using ListenerPointer = std::unique_ptr<dds_listener_t, void (*)(dds_listener_t*)>;

/// Reports matches and incompatible QoS of a writer. `events` outlives the writer's entity.
ListenerPointer WriterListener(EndpointEvents& events);

/// Delivers data and reports matches, liveliness and incompatible QoS. `reader` outlives its
/// entity.
ListenerPointer ReaderListener(CycloneReader& reader);

}  // namespace conav::bus
