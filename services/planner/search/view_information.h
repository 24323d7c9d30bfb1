#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "planner/search/offered_actions.h"
#include "planner/search/path_state.h"
#include "planner/search/perception_model.h"

namespace conav::planner {

/// R_info of the views offered at the end of a path, asked of the perception model in as few calls
/// as possible and remembered within one decision.
///
/// Nothing is approximated: the key is the whole set of cells in tau together with the place, and
/// an answer depends on tau as a set only. All views of a place are asked in one batch; with
/// `look_ahead` the places one move further are asked with them, because the search will most
/// likely stop there next (fewer calls, more queries).
class ViewInformation {
 public:
  struct Counts {
    std::uint32_t queries = 0;  // asked of the model
    std::uint32_t calls = 0;    // in this many batches
    std::uint32_t cached = 0;   // looked up again
  };

  /// All arguments must outlive this.
  ViewInformation(const SearchProblem& problem, OfferedActions& offered, PerceptionModel& model,
                  bool look_ahead);

  /// Expected edits of view `index` of the views offered at the end of `path`.
  /// Errors: those of the perception model.
  [[nodiscard]] Result<double> Of(const PathState& path, std::size_t index);

  const Counts& counts() const { return counts_; }

 private:
  struct Place {
    VertexId vertex = 0;
    std::vector<std::uint64_t> visited;
    bool operator==(const Place&) const = default;
  };
  struct PlaceHash {
    std::size_t operator()(const Place& place) const;
  };

  [[nodiscard]] Result<void> AskAround(const PathState& path);
  void AddQueries(const Place& place, const PathState& path);
  std::vector<Cell> CellsOf(const Place& place, const PathState& path) const;

  const SearchProblem& problem_;
  OfferedActions& offered_;
  PerceptionModel& model_;
  bool look_ahead_;
  std::unordered_map<Place, std::vector<double>, PlaceHash> known_;
  Place place_;                           // reused for look-ups
  std::vector<Place> asked_;              // places of the batch being built
  std::vector<PerceptionQuery> queries_;  // the batch being built
  Counts counts_;
};

}  // namespace conav::planner
