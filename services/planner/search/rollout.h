#pragma once

#include <cstdint>
#include <vector>

#include "common/runtime/random.h"
#include "planner/search/search_options.h"
#include "planner/search/view_information.h"

namespace conav::planner {

/// Stage 3 of an iteration: random actions from the end of a path until a goal is reached, a view
/// is sent or the depth is used up (procedure ROLLOUT, appendix C). Whether an unknown cell is free
/// is drawn once per rollout and remembered; a robot that cannot move stays where it is (A8).
///
/// Its moves are kept apart from the path: what a move needs lies in a few kilobytes, and the path
/// is walked only when a view is asked about. Takes no memory after construction.
class Rollout {
 public:
  /// All arguments must outlive this. `path` is a path of the decision: goals and the like are
  /// those of all paths.
  Rollout(const SearchOptions& options, const PathState& path, const OfferedActions& offered,
          ViewInformation& information, Random& random);

  /// Discounted return of the steps after `path`, which is given back as it was. 0 when nothing is
  /// offered. Errors: those of the perception model.
  [[nodiscard]] Result<double> Run(PathState& path);

  /// Moves made so far, in all rollouts.
  std::uint64_t moves() const { return moves_; }

 private:
  /// What a move into a vertex is worth, as far as it is the same for all rollouts: MoveReward() in
  /// parts, so that the innermost loop has few branches.
  struct Vertex {
    double environment = 0.0;      // EnvironmentReward
    double guidance_weight = 0.0;  // of log |tau|: 0 or -1
    double steps_to_goal = 0.0;
    bool is_goal = false;
  };
  /// What this rollout did with a vertex, or found out about an uncertainty; of an earlier rollout
  /// unless `rollout` is the present number.
  struct Visits {
    std::uint32_t rollout = 0;
    int count = 0;
  };
  struct Outcome {
    std::uint32_t rollout = 0;
    bool free = false;
  };

  int DrawAction(const Actions& actions);
  bool CanGo(const Edge& edge, const PathState& path);
  /// Enters `vertex`, or stays there; the reward of that (MoveReward).
  double Enter(VertexId from, VertexId vertex, const PathState& path);
  [[nodiscard]] Result<double> Communicate(PathState& path, std::size_t view);

  const SearchOptions& options_;
  const OfferedActions& offered_;
  ViewInformation& information_;
  Random& random_;
  const LogTable& log_;
  std::vector<Vertex> vertices_;
  std::vector<Visits> visits_;      // by vertex
  std::vector<Outcome> outcomes_;   // by uncertainty
  std::vector<const Edge*> steps_;  // of this rollout; null = stayed
  std::uint32_t rollout_ = 0;       // number of the present one
  int length_ = 0;                  // |tau|
  std::uint64_t moves_ = 0;
};

}  // namespace conav::planner
