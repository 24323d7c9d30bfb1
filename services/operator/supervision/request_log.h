#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "common/msg/supervision.h"
#include "common/runtime/log.h"
#include "operator/belief/belief_store.h"

// One user: the service; pure, and tested without it.

namespace conav::operators {

/// Counts decided requests and writes them to the process's log, refusals at most once a second.
///
/// A refusal that is not stored is decided again when its request is repeated; the newest of them
/// are remembered here, so that each is logged once.
/// Threads: one, the service's.
class RequestLog {
 public:
  static constexpr std::size_t kRefusalsRemembered = 256;

  /// `now`: simulation time of the request's world. True when the operator's command log is to have
  /// it: it was decided for the first time, and is neither a low-level action nor without effect.
  bool Note(const OperatorRequest& request, const BeliefStore::Answer& answer, SimTime now);

  /// Repeats are not counted again.
  std::uint64_t accepted() const { return accepted_; }
  std::uint64_t refused() const { return refused_; }

 private:
  /// False for one that is remembered.
  bool RememberRefusal(const OperatorRequest& request);

  std::uint64_t accepted_ = 0;
  std::uint64_t refused_ = 0;
  std::deque<std::pair<std::string, std::uint64_t>> refusals_;  // client and id, oldest first
  LogLimit refusals_logged_;
};

}  // namespace conav::operators
