#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/msg/perception_model.h"
#include "planner/search/path_state.h"
#include "planner/search/search_problem.h"

namespace conav::planner {

/// R_info of the views offered at the end of a path, asked of the perception model on demand and
/// remembered within one decision.
///
/// Nothing is approximated: the key is the set of cells in tau (PathState::set_key) together with the
/// place and the view, and an answer depends on tau as a set only. A search looks at few of a place's
/// views, so it asks about each by itself; AskAll() asks about all of a place (the root) in one batch.
/// The views of SearchProblem::poor_views are worth 0, unasked.
///
/// A look-up allocates nothing; a new place allocates only beyond the first kPlacesExpected.
class ViewInformation {
 public:
  static constexpr std::size_t kPlacesExpected = 1024;

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

  /// Asks for all views offered at the end of `path` that are not known yet, in one batch.
  [[nodiscard]] Result<void> AskAll(const PathState& path);

  /// Of the same view, if it was asked about already; counts as no look-up.
  std::optional<double> Known(const PathState& path, std::size_t index) const;

  /// Every view that was asked about, with the most that it was worth on any path; by cell, then
  /// heading. At most `limit`, those worth most.
  std::vector<ReportedView> Asked(std::size_t limit) const;

  const Counts& counts() const { return counts_; }

 private:
  /// A vertex and the vertices visited.
  struct Place {
    VertexId vertex;
    PathState::SetKey visited;
    std::size_t first_edit;  // of its views, in edits_
  };

  const Place& PlaceAt(const PathState& path);
  std::size_t SlotOf(VertexId vertex, const PathState::SetKey& visited) const;
  void AddPlace(const PathState& path, std::size_t slot);
  void GrowSlots();
  [[nodiscard]] Result<void> Ask(const PathState& path, const Place& place, std::size_t first,
                                 std::size_t count);

  const SearchProblem& problem_;
  OfferedActions& offered_;
  PerceptionModel& model_;
  std::vector<std::int32_t> slots_;  // open addressing: index into places_, -1 = empty
  std::vector<Place> places_;
  std::vector<double> edits_;       // NaN = not asked yet
  std::vector<ShownView> shown_;    // of the newest call; kept for their memory
  std::vector<std::size_t> asked_;  // its views: indices of those offered
  Counts counts_;
};

/// One view of each cell and heading, with the most that it was worth, by cell and heading; at most
/// `limit`, those worth most.
std::vector<ReportedView> MostOfEach(std::vector<ReportedView> views, std::size_t limit);

/// A view from the robot's place, and what it is expected to change.
struct BestView {
  double heading_rad = 0.0;
  double information = 0.0;  // R_info: expected edits, in cells
  int views = 0;             // that were compared, each asked of the model
};

/// Of the views offered at the start of `problem` with `least_information` or more (expected edits,
/// in cells) the one with the largest information less `turn_cost` for each radian that the robot
/// turns, the first of equals; nothing where there is none. For policies other than the search that
/// decide to send a picture now. Errors: those of the model.
[[nodiscard]] Result<std::optional<BestView>> FindBestView(const SearchProblem& problem,
                                                           PerceptionModel& model,
                                                           double least_information = 0.0,
                                                           double turn_cost = 0.0);

}  // namespace conav::planner
