#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "common/runtime/clock.h"
#include "common/runtime/log_limit.h"
#include "common/runtime/random.h"
#include "planner/decision/belief_estimate.h"
#include "planner/decision/communication_policy.h"
#include "planner/decision/method.h"
#include "planner/decision/no_news_model.h"
#include "planner/decision/operator_reliability.h"
#include "planner/decision/search_config.h"
#include "planner/decision/sent_views.h"
#include "planner/search/best_view.h"
#include "planner/search/grid_graph.h"
#include "planner/search/ig_mcts.h"

namespace conav::planner {

/// The robot decides by IG-MCTS: moves by itself, and sends the picture that is worth the
/// operator's attention. It never waits for guidance; the newest path is taken into account at each
/// decision. With an `estimate` it searches on that instead of the published belief. With a
/// `policy` that decides when a picture is sent, and the search on the moves only: it plans as if
/// pictures changed nothing, a branch still ends where it would send one, at the same cost, and
/// none is sent from where the robot is.
class IgMctsMethod final : public Method {
 public:
  IgMctsMethod(const SearchConfig& config, std::uint64_t seed,
               std::shared_ptr<PerceptionModel> model, const Clock& clock,
               std::shared_ptr<BeliefEstimate> estimate = nullptr,
               std::unique_ptr<CommunicationPolicy> policy = nullptr);

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> WayFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kAnswers; }

 private:
  /// The view that the last decision asked for; it counts as sent when the robot shows one more
  /// snapshot.
  struct ChosenView {
    SentViews::View view;
    VisibleCells visible;
    std::vector<Cell> path;  // tau at that time
    BeliefGrid belief;
    std::uint64_t snapshots_before = 0;
  };

  /// Where the world began anew with a map of another size, what was sent and measured of the one
  /// before tells nothing.
  void ForgetOtherSize(const OccupancyGrid& map);
  void NoteSentView(const Situation& situation);
  /// Asks what edits the picture of `chosen`, which was sent, will lead to.
  void ExpectEdits(const ChosenView& chosen);
  BeliefGrid BeliefOf(const Situation& situation);
  /// Whether to wait a moment for the robot that stands in the way and has to make room.
  bool WaitsForRoom(const Situation& situation);
  PerceptionModel& SearchModel() {
    return policy_ ? static_cast<PerceptionModel&>(no_news_) : *model_;
  }
  Decision Search(const SearchProblem& problem, const Situation& situation, const StopToken& stop);
  /// The view that the policy wants sent now, if any.
  Result<std::optional<BestView>> ViewOfPolicy(const SearchProblem& problem,
                                               const Situation& situation);
  Decision NoDecision(const Situation& situation, std::string_view reason);
  Decision FromResult(const SearchResult& result, const Situation& situation);
  Decision FromPolicy(const BestView& view, const Situation& situation);
  /// Makes `decision` the one to send a view.
  void Send(double heading_rad, double information, const Situation& situation, Decision& decision);

  SearchConfig config_;
  std::shared_ptr<PerceptionModel> model_;
  std::unique_ptr<CommunicationPolicy> policy_;  // null: the search decides
  NoNewsModel no_news_;                          // what it plans with where it does not
  IgMcts search_;
  std::vector<SearchMemory> memories_;  // by tree
  std::shared_ptr<const GridViews> views_;
  Random random_;
  const Clock& clock_;                        // of the search's wall time budget and of waiting
  std::shared_ptr<BeliefEstimate> estimate_;  // may be null
  std::optional<OperatorReliability> reliability_;  // none where it is not measured
  SentViews sent_views_;
  std::optional<ChosenView> chosen_view_;
  std::pair<int, int> map_size_;  // rows and columns at the last decision
  LogLimit no_decision_;
  std::optional<Clock::TimePoint> waiting_since_;  // for another robot to make room
};

}  // namespace conav::planner
