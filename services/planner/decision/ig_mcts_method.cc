#include "planner/decision/ig_mcts_method.h"

#include "common/runtime/log.h"
#include "planner/decision/situation_problem.h"
#include "planner/decision/traffic.h"
#include "planner/decision/value_lost.h"

namespace conav::planner {
namespace {

std::vector<SentView> ToSearch(const std::vector<SentViews::View>& views) {
  std::vector<SentView> sent;
  for (const auto& view : views) sent.push_back({view.cell, view.heading_rad});
  return sent;
}

}  // namespace

IgMctsMethod::IgMctsMethod(const SearchConfig& config, std::uint64_t seed,
                           std::shared_ptr<PerceptionModel> model, const Clock& clock,
                           std::shared_ptr<BeliefEstimate> estimate)
    : config_(config),
      model_(std::move(model)),
      search_(config.options, *model_),
      random_(seed),
      clock_(clock),
      estimate_(std::move(estimate)) {}

bool IgMctsMethod::WaitsForRoom(const Situation& situation) {
  if (WaitsFor(situation, DesiredWay(situation)) == nullptr) {
    waiting_since_.reset();
    return false;
  }
  if (!waiting_since_) waiting_since_ = clock_.Now();
  return clock_.Now() - *waiting_since_ < kPatience;
}

std::vector<Cell> IgMctsMethod::WayFor(const Situation& situation) { return DesiredWay(situation); }

void IgMctsMethod::NoteSentView(const Situation& situation) {
  if (chosen_view_ && situation.state.snapshots > chosen_view_->snapshots_before) {
    const SentViews::View view = chosen_view_->view;
    sent_views_.Sent(view, chosen_view_->visible);
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

BeliefGrid IgMctsMethod::BeliefOf(const Situation& situation) {
  return estimate_ ? estimate_->Now(situation.belief.wall_probability)
                   : situation.belief.wall_probability;
}

Decision IgMctsMethod::Decide(const Situation& situation, const StopToken& stop) {
  NoteSentView(situation);
  const BeliefGrid belief = BeliefOf(situation);
  sent_views_.Update(belief);
  if (WaitsForRoom(situation)) return {};
  views_ = ViewsFor(situation, config_.headings, std::move(views_));
  const SituationProblem problem(situation, belief, ToSearch(sent_views_.Withheld()), views_);
  if (problem.get() == nullptr) {
    return NoDecision(situation, "the robot's cell cannot be free on its map");
  }
  const auto result =
      search_.Decide(*problem.get(), random_, {.stop = &stop, .clock = &clock_}, &memories_);
  if (!result) {
    return NoDecision(situation, result.error().text);
  }
  return FromResult(*result, situation);
}

Decision IgMctsMethod::NoDecision(const Situation& situation, std::string_view reason) {
  if (const auto held_back = no_decision_.Allow()) {
    LOG_WARNING("no decision", "robot", situation.state.robot, "cell", situation.state.cell,
                "reason", reason, "held_back", *held_back);
  }
  return {};
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
  const CameraView view = ViewThrough(situation.lens, situation.state.cell, chosen.heading_rad,
                                      situation.map.cell_size_m);
  chosen_view_ = ChosenView{{situation.state.cell, chosen.heading_rad},
                            CastView(situation.map.cells, view),
                            situation.state.path,
                            situation.state.snapshots};
  decision.attention = AttentionReason::kPicture;
  decision.attention_cell = situation.state.cell;
  decision.expected_information = chosen.information_gain;
  decision.answer_value = AnswerValue(result.actions, chosen);
  return decision;
}

}  // namespace conav::planner
