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
/// an answer depends on tau as a set only. All views of a place are asked in one batch, when the
/// first of them is wanted. Searches of 2000 iterations need about 13 batches, because they come
/// back to the same places (asking about the places around in the same batch saved one call in
/// seven and doubled the queries, so it is not done).
class ViewInformation {
 public:
  struct Counts {
    std::uint32_t queries = 0;  // asked of the model
    std::uint32_t calls = 0;    // in this many batches
    std::uint32_t cached = 0;   // looked up again
  };

  /// All arguments must outlive this.
  ViewInformation(const SearchProblem& problem, OfferedActions& offered, PerceptionModel& model);

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

  [[nodiscard]] Result<std::vector<double>> Ask(const PathState& path);
  std::vector<Cell> CellsOf(const PathState& path) const;

  const SearchProblem& problem_;
  OfferedActions& offered_;
  PerceptionModel& model_;
  std::unordered_map<Place, std::vector<double>, PlaceHash> known_;
  Place place_;  // of the present look-up
  Counts counts_;
};

}  // namespace conav::planner
