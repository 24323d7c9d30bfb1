#include "planner/search/view_information.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "common/runtime/result.h"
#include "planner/search/reward.h"

namespace conav::planner {
namespace {

constexpr std::int32_t kEmpty = -1;
constexpr std::size_t kViewsExpected = 8;  // of a place

}  // namespace

ViewInformation::ViewInformation(const SearchProblem& problem, OfferedActions& offered,
                                 PerceptionModel& model)
    : problem_(problem), offered_(offered), model_(model), slots_(4 * kPlacesExpected, kEmpty) {
  places_.reserve(kPlacesExpected);
  edits_.reserve(kPlacesExpected * kViewsExpected);
  shown_.resize(kViewsExpected);
}

Result<double> ViewInformation::Of(const PathState& path, std::size_t index) {
  const Place& place = PlaceAt(path);
  DEMAND(index < offered_.At(place.vertex).views.size(), index);
  const double& edits = edits_[place.first_edit + index];
  if (!std::isnan(edits)) {
    ++counts_.cached;
    return edits;
  }
  if (auto asked = Ask(path, place, index, 1); !asked) return tl::unexpected(asked.error());
  return edits;
}

Result<void> ViewInformation::AskAll(const PathState& path) {
  const Place& place = PlaceAt(path);
  const std::size_t views = offered_.At(place.vertex).views.size();
  return views == 0 ? Result<void>() : Ask(path, place, 0, views);
}

std::optional<double> ViewInformation::Known(const PathState& path, std::size_t index) const {
  const std::int32_t number = slots_[SlotOf(path.vertex(), path.set_key())];
  if (number == kEmpty) return std::nullopt;
  const double edits = edits_[places_[static_cast<std::size_t>(number)].first_edit + index];
  return std::isnan(edits) ? std::nullopt : std::optional(edits);
}

std::vector<ReportedView> ViewInformation::Asked(std::size_t limit) const {
  std::vector<ReportedView> asked;
  for (const Place& place : places_) {
    const auto views = offered_.At(place.vertex).views;
    const auto headings = problem_.graph.HeadingsAt(place.vertex);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const double edits = edits_[place.first_edit + i];
      if (std::isnan(edits)) continue;
      asked.push_back({problem_.graph.CellOf(place.vertex),
                       headings[static_cast<std::size_t>(views[i])], edits});
    }
  }
  return MostOfEach(std::move(asked), limit);
}

const ViewInformation::Place& ViewInformation::PlaceAt(const PathState& path) {
  const std::size_t slot = SlotOf(path.vertex(), path.set_key());
  if (slots_[slot] != kEmpty) return places_[static_cast<std::size_t>(slots_[slot])];
  AddPlace(path, slot);
  return places_.back();
}

/// The slot that holds this place, or the empty one where it belongs.
std::size_t ViewInformation::SlotOf(VertexId vertex, const PathState::SetKey& visited) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = (visited[0] + static_cast<std::uint64_t>(vertex)) & mask;
  const auto is_here = [&](const Place& place) {
    return place.vertex == vertex && place.visited == visited;
  };
  while (slots_[slot] != kEmpty && !is_here(places_[static_cast<std::size_t>(slots_[slot])])) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

/// Views [first, first + count) of a place.
Result<void> ViewInformation::Ask(const PathState& path, const Place& place, std::size_t first,
                                  std::size_t count) {
  const auto views = offered_.At(place.vertex).views;
  const auto headings = problem_.graph.HeadingsAt(place.vertex);
  asked_.clear();
  for (std::size_t i = first; i < first + count; ++i) {
    if (std::isnan(edits_[place.first_edit + i])) asked_.push_back(i);
  }
  if (asked_.empty()) return {};
  shown_.resize(std::max(shown_.size(), asked_.size()));
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    const int view = views[asked_[i]];
    path.CollectCells(shown_[i].path);
    shown_[i].cell = problem_.graph.CellOf(place.vertex);
    shown_[i].heading_rad = headings[static_cast<std::size_t>(view)];
    shown_[i].visible = problem_.graph.ViewFrom(place.vertex, view);
  }
  const auto answers = model_.PredictEdits(problem_.belief, std::span(shown_).first(asked_.size()));
  if (!answers) return tl::unexpected(answers.error());
  DEMAND(answers->size() == asked_.size(), answers->size(), asked_.size());
  ++counts_.calls;
  counts_.queries += static_cast<std::uint32_t>(asked_.size());
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    edits_[place.first_edit + asked_[i]] = problem_.information_weight * (*answers)[i] +
                                           HiddenWorth(problem_, shown_[i].visible) +
                                           problem_.answer_value;
  }
  return {};
}

void ViewInformation::AddPlace(const PathState& path, std::size_t slot) {
  slots_[slot] = static_cast<std::int32_t>(places_.size());
  places_.push_back({path.vertex(), path.set_key(), edits_.size()});
  const auto headings = problem_.graph.HeadingsAt(path.vertex()).size();
  for (const int view : offered_.At(path.vertex()).views) {
    const std::size_t number =
        static_cast<std::size_t>(path.vertex()) * headings + static_cast<std::size_t>(view);
    const bool is_poor = !problem_.poor_views.empty() && problem_.poor_views[number] != 0;
    edits_.push_back(is_poor ? 0.0 : std::numeric_limits<double>::quiet_NaN());
  }
  if (2 * places_.size() > slots_.size()) GrowSlots();
}

void ViewInformation::GrowSlots() {
  slots_.assign(2 * slots_.size(), kEmpty);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    slots_[SlotOf(places_[i].vertex, places_[i].visited)] = static_cast<std::int32_t>(i);
  }
}

std::vector<ReportedView> MostOfEach(std::vector<ReportedView> views, std::size_t limit) {
  const auto place = [](const ReportedView& view) {
    return std::tuple(view.cell.row, view.cell.column, view.heading_rad);
  };
  std::sort(views.begin(), views.end(), [&](const ReportedView& a, const ReportedView& b) {
    if (place(a) != place(b)) return place(a) < place(b);
    return a.information_gain > b.information_gain;
  });
  const auto same_place = [&](const ReportedView& a, const ReportedView& b) {
    return place(a) == place(b);
  };
  views.erase(std::unique(views.begin(), views.end(), same_place), views.end());
  if (views.size() <= limit) return views;
  std::stable_sort(views.begin(), views.end(), [](const ReportedView& a, const ReportedView& b) {
    return a.information_gain > b.information_gain;
  });
  views.resize(limit);
  std::sort(views.begin(), views.end(),
            [&](const ReportedView& a, const ReportedView& b) { return place(a) < place(b); });
  return views;
}

Result<std::optional<BestView>> FindBestView(const SearchProblem& problem, PerceptionModel& model,
                                             double least_information, double turn_cost) {
  const PathState path(problem);
  OfferedActions offered(problem);
  ViewInformation information(problem, offered, model);
  if (auto asked = information.AskAll(path); !asked) return tl::unexpected(asked.error());
  const auto views = offered.At(problem.start).views;
  const auto headings = problem.graph.HeadingsAt(problem.start);
  RewardOptions turns;
  turns.view_turn = turn_cost;
  std::optional<BestView> best;
  double best_value = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto edits = information.Of(path, i);
    if (!edits) return tl::unexpected(edits.error());
    const double heading_rad = headings[static_cast<std::size_t>(views[i])];
    const double value = *edits - TurnCost(path, heading_rad, turns);
    if (*edits < least_information || (best && value <= best_value)) continue;
    best_value = value;
    best = {heading_rad, *edits, static_cast<int>(views.size())};
  }
  return best;
}

}  // namespace conav::planner
