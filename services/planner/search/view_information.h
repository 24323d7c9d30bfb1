#pragma once

#include <cstdint>
#include <span>
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
///
/// A look-up takes no memory; a new place only beyond the first kPlacesExpected.
class ViewInformation {
 public:
  static constexpr std::size_t kPlacesExpected = 1024;

  struct Counts {
    std::uint32_t queries = 0;  // asked of the model
    std::uint32_t calls = 0;    // in this many batches
    std::uint32_t cached = 0;   // looked up again
  };

  /// All arguments must outlive this.
  ViewInformation(const SearchProblem& problem, const OfferedActions& offered,
                  PerceptionModel& model);

  /// Expected edits of view `index` of the views offered at the end of `path`.
  /// Errors: those of the perception model.
  [[nodiscard]] Result<double> Of(const PathState& path, std::size_t index);

  const Counts& counts() const { return counts_; }

 private:
  /// A place that was asked about: a vertex and the vertices visited, edits of its views.
  struct Place {
    VertexId vertex;
    std::size_t first_word;  // in words_
    std::size_t first_edit;  // in edits_
  };

  std::size_t SlotOf(const PathState& path) const;
  bool Is(const Place& place, const PathState& path) const;
  [[nodiscard]] Result<const Place*> Ask(const PathState& path, std::size_t slot);
  void WriteQueries(const PathState& path);
  void CollectCells(const PathState& path);
  void Remember(const PathState& path, std::size_t slot, std::span<const PerceptionAnswer> answers);
  void GrowSlots();

  const SearchProblem& problem_;
  const OfferedActions& offered_;
  PerceptionModel& model_;
  std::vector<std::int32_t> slots_;  // open addressing: index into places_, -1 = empty
  std::vector<Place> places_;
  std::vector<std::uint64_t> words_;
  std::vector<double> edits_;
  std::vector<PerceptionQuery> queries_;  // of the newest call; kept for their memory
  std::vector<Cell> cells_;               // of its path
  Counts counts_;
};

}  // namespace conav::planner
