#include "planner/methods/ig_mcts_method.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/grid/geometry.h"
#include "common/grid/map_accuracy.h"
#include "planner/decision/traffic.h"
#include "planner/search/grid_steps.h"

namespace conav::planner {
namespace {

std::vector<Cell> PathOf(const Situation& situation) {
  return situation.guidance ? situation.guidance->path : std::vector<Cell>{};
}

/// Large regions may have any number of small ones around them.
bool FitsActions(const NavigationGraph& graph) {
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    const std::size_t actions = graph.EdgesFrom(vertex).size() + graph.HeadingsAt(vertex).size();
    if (actions > static_cast<std::size_t>(kMaxActions)) return false;
  }
  return true;
}

/// Cells that the operator's map has wrong, by the robot's: how many in each square of kBlock cells.
constexpr int kBlock = 4;
struct WrongBlock {
  double row = 0.0;  // of its middle
  double column = 0.0;
  int cells = 0;
};

bool IsWrong(Occupancy known, float believed) {
  return known != Occupancy::kUnknown &&
         (known == Occupancy::kOccupied) != (believed >= kWallThreshold);
}

std::vector<WrongBlock> WrongBlocks(const OccupancyGrid& known, const BeliefGrid& belief) {
  std::vector<WrongBlock> blocks;
  for (int row = 0; row < known.rows(); row += kBlock) {
    for (int column = 0; column < known.columns(); column += kBlock) {
      WrongBlock block{row + 0.5 * (kBlock - 1), column + 0.5 * (kBlock - 1), 0};
      for (int i = 0; i < kBlock * kBlock; ++i) {
        const Cell cell{row + i / kBlock, column + i % kBlock};
        if (known.Contains(cell) && IsWrong(known[cell], belief[cell])) ++block.cells;
      }
      if (block.cells > 0) blocks.push_back(block);
    }
  }
  return blocks;
}

/// SearchProblem::poor_views: those whose sector, walls left aside, holds fewer than `least_cells` wrong
/// ones. A picture also tells of the robot's path.
std::vector<std::uint8_t> PoorViews(const Situation& situation, const BeliefGrid& belief,
                                    const NavigationGraph& graph, double range_cells,
                                    double least_cells) {
  const OccupancyGrid& known = situation.map.cells;
  const std::vector<WrongBlock> blocks = WrongBlocks(known, belief);
  const auto on_path = std::ranges::count_if(
      situation.state.path, [&](Cell cell) { return IsWrong(known[cell], belief[cell]); });
  std::vector<std::uint8_t> poor;
  std::vector<double> shown;  // by heading
  for (VertexId vertex = 0; vertex < graph.vertex_count(); ++vertex) {
    const Cell from = graph.CellOf(vertex);
    const auto headings = graph.HeadingsAt(vertex);
    shown.assign(headings.size(), static_cast<double>(on_path));
    for (const WrongBlock& block : blocks) {
      const double east = block.column - from.column;
      const double north = from.row - block.row;
      const double distance = std::hypot(east, north);
      if (distance > range_cells + kBlock) continue;
      const double bearing_rad = std::atan2(north, east);
      const double margin_rad = std::asin(std::min(1.0, kBlock / std::max(distance, 1.0)));
      for (std::size_t i = 0; i < headings.size(); ++i) {
        const double off_rad = std::abs(WrapAngle(bearing_rad - headings[i]));
        if (off_rad <= 0.5 * situation.lens.horizontal_fov_rad + margin_rad) {
          shown[i] += block.cells;
        }
      }
    }
    for (const double cells : shown) poor.push_back(cells < least_cells ? 1 : 0);
  }
  return poor;
}

/// Whether the operator's path leads through a wall that the robot knows of.
bool IsBlocked(const Situation& situation) {
  return IsKnownBlocked(situation.map.cells, PathOf(situation));
}

}  // namespace

std::shared_ptr<const GridViews> ViewsFor(const Situation& situation, int headings,
                                          std::shared_ptr<const GridViews> kept,
                                          double range_cells) {
  const GridViews::Options options{.headings = headings,
                                   .lens = situation.lens,
                                   .cell_size_m = situation.map.cell_size_m,
                                   .range_cells = range_cells};
  if (kept && kept->options() == options) return kept;
  return std::make_shared<const GridViews>(options);
}

SituationProblem::SituationProblem(const Situation& situation, SharedBelief belief,
                                   std::vector<SentView> withheld,
                                   std::shared_ptr<const GridViews> views, const Reliance& reliance,
                                   std::shared_ptr<GridSteps> steps)
    : belief_(std::move(belief)) {
  const GridGraph& graph = cells_.emplace(situation.map.cells, TakenCells(situation),
                                          std::move(views), std::move(steps));
  const auto start = graph.VertexAt(situation.state.cell);
  if (start) Pose(situation, graph, *start, std::move(withheld), reliance);
}

SituationProblem::SituationProblem(const Situation& situation, SharedBelief belief,
                                   std::vector<SentView> withheld, const RegionNavigation& regions,
                                   const Reliance& reliance, double view_range_cells,
                                   double least_information)
    : belief_(std::move(belief)) {
  const auto start = regions.VertexNear(situation.state.cell);
  if (!start || !FitsActions(regions.graph())) return;
  for (SentView& view : withheld) view.cell = regions.Traversable({view.cell}).front();
  Pose(situation, regions.graph(), *start, std::move(withheld), reliance);
  problem_->goals_left = regions.Traversable(std::move(problem_->goals_left));
  problem_->guidance = regions.FollowablePath(problem_->guidance);
  const double cell_area = situation.map.cell_size_m * situation.map.cell_size_m;
  problem_->information_weight *= cell_area;
  problem_->poor_views = PoorViews(situation, *belief_, regions.graph(), view_range_cells,
                                   least_information / cell_area);
}

void SituationProblem::Pose(const Situation& situation, const NavigationGraph& graph,
                            VertexId start, std::vector<SentView> withheld,
                            const Reliance& reliance) {
  const bool counts_as_none = !reliance.blocked_path_guides && IsBlocked(situation);
  problem_.emplace(
      SearchProblem{.graph = graph,
                    .start = start,
                    .heading_rad = situation.state.heading_rad,
                    .path = situation.state.path,
                    .goals_left = situation.state.goals_left,
                    .guidance = counts_as_none ? std::vector<Cell>{} : PathOf(situation),
                    .guided_before = situation.guided_before && !counts_as_none,
                    .belief = belief_,
                    .information_weight = reliance.information_weight,
                    .sent_views = std::move(withheld),
                    .believed_wall_steps = reliance.believed_wall_steps,
                    .off_guidance_steps = reliance.off_guidance_steps});
}

namespace {

std::vector<SentView> ToSearch(const std::vector<SentViews::View>& views) {
  std::vector<SentView> sent;
  for (const auto& view : views) sent.push_back({view.cell, view.heading_rad});
  return sent;
}

/// A policy's choice is taken from the search by withholding all views of the robot's place.
SearchOptions OptionsFor(SearchOptions options, bool has_policy) {
  if (has_policy) options.offers_sent_views = false;
  return options;
}

SearchProblem WithoutViewsHere(SearchProblem problem) {
  const Cell here = problem.graph.CellOf(problem.start);
  for (const double heading_rad : problem.graph.HeadingsAt(problem.start)) {
    problem.sent_views.push_back({here, heading_rad});
  }
  return problem;
}

}  // namespace

IgMctsMethod::IgMctsMethod(const SearchConfig& config, std::uint64_t seed,
                           std::shared_ptr<PerceptionModel> model, const Clock& clock,
                           std::shared_ptr<BeliefEstimate> estimate,
                           std::optional<CommunicationPolicy> policy)
    : config_(config),
      model_(std::move(model)),
      policy_(std::move(policy)),
      search_(OptionsFor(config.options, policy_.has_value()), SearchModel()),
      random_(seed),
      clock_(clock),
      estimate_(std::move(estimate)),
      steps_(std::make_shared<GridSteps>()) {
  if (config.graph == SearchGraph::kRegions) regions_.emplace(config.regions);
  // An estimate holds what is expected, so there is nothing to measure.
  if (config.reliability_prior > 0.0 && !estimate_) {
    reliability_.emplace(config.reliability_prior);
  }
}

void IgMctsMethod::ForgetOtherSize(const OccupancyGrid& map) {
  const std::pair size(map.rows(), map.columns());
  if (std::exchange(map_size_, size) == size) return;
  sent_views_ = {};
  hidden_goals_ = {};
  answer_trust_ = {};
  chosen_view_.reset();
  if (reliability_) reliability_.emplace(config_.reliability_prior);
}

void IgMctsMethod::Prepare(const OccupancyGrid& map) {
  if (regions_) regions_->Prepare(map);
}

bool IgMctsMethod::WaitsForRoom(const Situation& situation) {
  if (regions_) return false;  // open water has another way
  const Neighbour* other = InTheWay(situation, DesiredPath(situation));
  if (other == nullptr) patience_.End();
  return other != nullptr && patience_.Holds(other);
}

std::vector<Cell> IgMctsMethod::IntendedPathFor(const Situation& situation) {
  return DesiredPath(situation);
}

void IgMctsMethod::NoteSentView(const Situation& situation) {
  if (chosen_view_ && situation.state.snapshots > chosen_view_->snapshots_before) {
    const SentViews::View view = chosen_view_->view;
    if (chosen_view_->asks_for_way) answer_trust_.Asked();
    hidden_goals_.Pictured(chosen_view_->visible, situation);
    sent_views_.Sent(view, chosen_view_->visible);
    if (!estimate_) ExpectEdits(*chosen_view_);
    if (estimate_) {
      const auto noted = estimate_->NoteSent(std::move(chosen_view_->path), view.cell,
                                             view.heading_rad, std::move(chosen_view_->visible));
      if (!noted) {
        LOG_WARNING("belief estimate not advanced", "robot", situation.state.robot, "reason",
                    noted.error().text);
      }
    }
  }
  chosen_view_.reset();
}

void IgMctsMethod::ExpectEdits(const ChosenView& chosen) {
  sent_ = PerceptionQuery{.belief = *chosen.belief,
                          .path = chosen.path,
                          .cell = chosen.view.cell,
                          .heading_rad = chosen.view.heading_rad,
                          .visible = chosen.visible};
  if (!reliability_) return;
  // Without an answer this picture says nothing about the operator.
  if (auto edits = model_->Predict({&*sent_, 1})) reliability_->Sent(std::move(edits->front()));
}

SharedBelief IgMctsMethod::BeliefOf(const Situation& situation) {
  if (estimate_) {
    return std::make_shared<const BeliefGrid>(estimate_->Now(situation.belief.wall_probability));
  }
  const BeliefGrid& published = situation.belief.wall_probability;
  if (!belief_ || !(*belief_ == published)) {
    belief_ = std::make_shared<const BeliefGrid>(published);
  }
  return belief_;
}

Decision IgMctsMethod::Decide(const Situation& situation, const StopToken& stop) {
  ForgetOtherSize(situation.map.cells);
  answer_trust_.Update(situation);
  NoteSentView(situation);
  const SharedBelief belief = BeliefOf(situation);
  sent_views_.Update(*belief);
  if (sent_) model_->ReceivedEdits(*std::exchange(sent_, std::nullopt), *belief);
  if (reliability_) {
    reliability_->Received(*belief, situation.map.cells, situation.map.cell_size_m);
  }
  if (WaitsForRoom(situation)) return patience_.Wait();
  views_ = ViewsFor(situation, config_.headings, std::move(views_), ViewRange());
  if (regions_) {
    regions_->Update(situation, views_);
    if (auto decision = regions_->ApproachGoal(situation)) return *std::move(decision);
  }
  SituationProblem problem = ProblemOf(situation, belief);
  if (problem.get() == nullptr) {
    return NoDecision(situation,
                      regions_ ? "no way on from its cell, or a region has too many neighbours"
                               : "the robot's cell cannot be free on its map");
  }
  const RewardOptions& reward = config_.options.reward;
  hidden_goals_.AddTo(*problem.get(), situation, reward.goal);
  if (situation.sends_no_pictures) {
    return Search(WithoutViewsHere(*problem.get()), situation, stop);
  }
  if (!policy_) {
    if (situation.lacks_way) {
      problem.get()->answer_value = reward.answer * reward.goal * answer_trust_.value();
    }
    return Search(*problem.get(), situation, stop);
  }
  const auto view = ViewOfPolicy(*problem.get(), situation);
  if (!view) return NoDecision(situation, view.error().text);
  if (*view) return FromPolicy(**view, situation);
  return Search(WithoutViewsHere(*problem.get()), situation, stop);
}

SituationProblem IgMctsMethod::ProblemOf(const Situation& situation, const SharedBelief& belief) {
  // A policy's threshold is in cells, whatever one is worth.
  const double cell_value = policy_ ? 1.0 : config_.mapping_value;
  const Reliance reliance{
      .information_weight = cell_value * (reliability_ ? reliability_->value() : 1.0),
      .blocked_path_guides = config_.blocked_path_guides,
      .believed_wall_steps = config_.believed_wall_steps,
      .off_guidance_steps = config_.off_guidance_steps};
  std::vector<SentView> withheld = ToSearch(sent_views_.Withheld());
  if (regions_)
    return {situation,
            belief,
            std::move(withheld),
            *regions_,
            reliance,
            ViewRange(),
            std::max(config_.options.min_information, config_.options.reward.communication_cost)};
  return {situation, belief, std::move(withheld), views_, reliance, steps_};
}

double IgMctsMethod::ViewRange() const {
  return config_.view_range_cells > 0.0 ? config_.view_range_cells
                                        : std::numeric_limits<double>::infinity();
}

Decision IgMctsMethod::Search(const SearchProblem& problem, const Situation& situation,
                              const StopToken& stop) {
  const auto result =
      search_.Decide(problem, random_, {.stop = &stop, .clock = &clock_}, &memories_);
  if (!result) return NoDecision(situation, result.error().text);
  return FromResult(*result, situation);
}

Result<std::optional<BestView>> IgMctsMethod::ViewOfPolicy(const SearchProblem& problem,
                                                           const Situation& situation) {
  if (!policy_ || problem.goals_left.empty() || !policy_->IsDue(MomentOf(situation))) {
    return std::nullopt;
  }
  return FindBestView(problem, *model_, policy_->least_information(), policy_->turn_cost());
}

Decision IgMctsMethod::NoDecision(const Situation& situation, std::string_view reason) {
  if (const auto held_back = no_decision_.Allow()) {
    LOG_WARNING("no decision", "robot", situation.state.robot, "cell", situation.state.cell,
                "reason", reason, "held_back", *held_back);
  }
  Decision later;
  later.again = Clock::TimePoint::min();  // it may be for the model
  return later;
}

Decision IgMctsMethod::FromResult(const SearchResult& result, const Situation& situation) {
  Decision decision;
  decision.report = result;
  decision.report.perception_model = SearchModel().identity().name;
  decision.plan = result.expected_path;
  if (result.chosen < 0) return decision;
  const SearchAction& chosen = result.actions[static_cast<std::size_t>(result.chosen)];
  decision.action = Action{chosen.kind, chosen.target, chosen.heading_rad};
  if (regions_ && chosen.kind == CommandKind::kMove) TakeRoute(situation, decision);
  if (chosen.kind == CommandKind::kTransmitView) {
    Send(chosen.heading_rad, chosen.information_gain, situation, decision);
    decision.answer_value = AnswerValue(result.actions, chosen);
  }
  return decision;
}

/// In the place of the straight line to the vertex, the first of the plan.
void IgMctsMethod::TakeRoute(const Situation& situation, Decision& decision) const {
  Decision along = regions_->MoveAlong(situation, decision.plan);
  decision.action = std::move(along.action);
  decision.plan = std::move(along.plan);
}

Decision IgMctsMethod::FromPolicy(const BestView& view, const Situation& situation) {
  Decision decision;
  decision.report.actions.push_back({.kind = CommandKind::kTransmitView,
                                     .target = situation.state.cell,
                                     .heading_rad = view.heading_rad,
                                     .information_gain = view.information});
  decision.report.chosen = 0;
  decision.report.perception_queries = static_cast<std::uint32_t>(view.views);
  decision.report.perception_model = model_->identity().name;
  decision.action = Action{CommandKind::kTransmitView, situation.state.cell, view.heading_rad};
  Send(view.heading_rad, view.information, situation, decision);
  return decision;
}

void IgMctsMethod::Send(double heading_rad, double information, const Situation& situation,
                        Decision& decision) {
  // The picture shows the truth, the robot's map what is known of it now: cells that it adds are
  // new to all.
  CameraView view =
      ViewThrough(situation.lens, situation.state.cell, heading_rad, situation.map.cell_size_m);
  view.range_cells = ViewRange();
  chosen_view_ = ChosenView{{situation.state.cell, heading_rad},
                            CastView(situation.map.cells, view),
                            situation.state.path,
                            BeliefOf(situation),
                            situation.state.snapshots,
                            situation.lacks_way};
  decision.attention = AttentionReason::kSnapshot;
  decision.attention_cell = situation.state.cell;
  decision.expected_information = information;
}

}  // namespace conav::planner
