#pragma once

#include "common/runtime/random.h"
#include "planner/search/search_options.h"
#include "planner/search/view_information.h"

namespace conav::planner {

/// Stage 3 of an iteration: random actions from the end of a path until a goal is reached, a view
/// is sent or the depth is used up (procedure ROLLOUT, appendix C). Whether an unknown cell is free
/// is drawn once per rollout and remembered; a robot that cannot move stays where it is (A8).
class Rollout {
 public:
  /// All arguments must outlive this.
  Rollout(const SearchOptions& options, const SearchProblem& problem, const OfferedActions& offered,
          ViewInformation& information, Random& random);

  /// Discounted return of the steps after `path`, which is given back as it was. 0 when nothing is
  /// offered. Errors: those of the perception model.
  [[nodiscard]] Result<double> Run(PathState& path);

  /// Moves made so far, in all rollouts.
  std::uint64_t moves() const { return moves_; }

 private:
  enum class Outcome : std::uint8_t { kNotDrawn, kFree, kBlocked };

  [[nodiscard]] Result<double> Walk(PathState& path);
  int DrawAction(const Actions& actions);
  void Move(const Edge& edge, PathState& path);
  bool DrawFree(const Edge& edge);

  const SearchOptions& options_;
  const OfferedActions& offered_;
  ViewInformation& information_;
  Random& random_;
  std::vector<Outcome> outcomes_;  // by uncertainty; those of drawn_ are set
  std::vector<int> drawn_;
  std::uint64_t moves_ = 0;
};

}  // namespace conav::planner
