#include "planner/ig_mcts_method.h"

#include "common/runtime/log.h"
#include "planner/follow_path.h"
#include "planner/search/grid_graph.h"
#include "planner/traffic.h"

namespace conav::planner {
namespace {

/// Wall time for which a robot waits for another one to make room.
constexpr std::chrono::milliseconds kPatience{300};

std::vector<Cell> CellsOf(const std::vector<Neighbour>& neighbours) {
  std::vector<Cell> cells;
  for (const Neighbour& neighbour : neighbours) cells.push_back(neighbour.cell);
  return cells;
}

std::vector<SentView> ToSearch(const std::vector<SentViews::View>& views) {
  std::vector<SentView> sent;
  for (const auto& view : views) sent.push_back({view.cell, view.heading_rad});
  return sent;
}

}  // namespace

IgMctsMethod::IgMctsMethod(const SearchConfig& config, std::uint64_t seed,
                           std::shared_ptr<PerceptionModel> model)
    : config_(config), model_(std::move(model)), search_(config.options, *model_), random_(seed) {}

std::optional<Decision> IgMctsMethod::MindTraffic(const Situation& situation) {
  if (const auto aside = StepAside(situation)) return MoveAlong({*aside});
  if (WaitsFor(situation, DesiredWay(situation)) == nullptr) {
    waiting_since_.reset();
    return std::nullopt;
  }
  if (!waiting_since_) waiting_since_ = clock_.Now();
  if (clock_.Now() - *waiting_since_ < kPatience) return Decision{};
  return std::nullopt;
}

Decision IgMctsMethod::Decide(const Situation& situation) {
  if (auto decision = MindTraffic(situation)) return *std::move(decision);
  sent_views_.Update(situation.belief.wall_probability);
  GridGraph::Options graph_options;
  graph_options.headings = config_.headings;
  const GridGraph graph(situation.map.cells, CellsOf(situation.neighbours), graph_options);
  const SearchProblem problem{
      .graph = graph,
      .start = graph.VertexAt(situation.state.cell).value_or(0),
      .path = situation.state.path,
      .goals_left = situation.state.goals_left,
      .guidance = situation.guidance ? situation.guidance->path : std::vector<Cell>{},
      .guided_before = situation.guided_before,
      .belief = situation.belief.wall_probability,
      .sent_views = ToSearch(sent_views_.Withheld())};
  const auto result = search_.Decide(problem, random_, {.clock = &clock_});
  if (!result) {
    LOG_WARNING("no decision", "robot", situation.state.robot, "reason", result.error().text);
    return {};
  }
  return FromResult(*result, situation);
}

Decision IgMctsMethod::FromResult(const SearchResult& result, const Situation& situation) {
  Decision decision;
  decision.report.actions = result.actions;
  decision.report.chosen = result.chosen;
  decision.report.iterations = result.iterations;
  decision.report.nodes = result.nodes;
  decision.report.perception_queries = result.perception_queries;
  decision.report.perception_cached = result.perception_cached;
  decision.report.perception_model = model_->name();
  decision.plan = result.expected_path;
  if (result.chosen < 0) return decision;
  const SearchAction& chosen = result.actions[static_cast<std::size_t>(result.chosen)];
  decision.action = Action{chosen.kind, chosen.target, chosen.heading_rad};
  if (chosen.kind != CommandKind::kTransmitView) return decision;
  // The picture shows the truth, the robot's map what is known of it now: cells that it adds are
  // new to all.
  CameraView view;
  view.cell = situation.state.cell;
  view.heading_rad = chosen.heading_rad;
  sent_views_.Sent({situation.state.cell, chosen.heading_rad}, CastView(situation.map.cells, view));
  decision.attention = AttentionReason::kPicture;
  decision.attention_cell = situation.state.cell;
  decision.expected_information = chosen.information_gain;
  return decision;
}

}  // namespace conav::planner
