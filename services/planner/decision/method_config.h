#pragma once

#include "planner/decision/communication_config.h"
#include "planner/decision/search_config.h"

namespace conav::planner {

/// The method of the mapping task, the only one that is told the true map.
inline constexpr const char* kMappingMethod = "mapping";

/// How method ig-mcts is set up; the others need nothing.
struct MethodConfig {
  SearchConfig search;
  CommunicationConfig communication;
};

}  // namespace conav::planner
