#pragma once

#include "planner/decision/communication_config.h"
#include "planner/decision/search_config.h"

namespace conav::planner {

/// How method ig-mcts is set up; the others need nothing.
struct MethodConfig {
  SearchConfig search;
  CommunicationConfig communication;
};

}  // namespace conav::planner
