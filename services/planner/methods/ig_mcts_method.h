#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/grid/grid.h"
#include "common/grid/visibility.h"
#include "common/msg/perception_model.h"
#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "common/runtime/random.h"
#include "planner/decision/method.h"
#include "planner/decision/traffic.h"
#include "planner/methods/method_config.h"
#include "planner/methods/operator_model.h"
#include "planner/methods/region_navigation.h"
#include "planner/methods/unknown_goals.h"
#include "planner/search/parallel_search.h"
#include "planner/search/search_problem.h"
#include "planner/search/view_information.h"

namespace conav::planner {

/// What a rule may look at when it decides whether a picture is sent now.
struct CommunicationMoment {
  int moves_since_snapshot = 0;  // since the start, before the first one
  bool sent_before = false;
  bool guidance_fails = false;  // GuidanceFails()
};

/// Whether the operator's path no longer leads the robot on: a known wall lies on what is left of
/// it, the robot is next to it or at its end, or it expired. Without any path so far: no.
bool GuidanceFails(const Situation& situation);

CommunicationMoment MomentOf(const Situation& situation);

/// A rule that sends pictures in the place of the search, for comparison with it. The heading is
/// the one with the largest expected information, less what its turn costs, of those not sent yet.
/// Threads: one worker's.
class CommunicationPolicy {
 public:
  /// `config.policy` names a rule, not "search".
  CommunicationPolicy(const CommunicationConfig& config, std::uint64_t seed);

  /// Whether a picture is to be sent before the next move. Asked once per decision.
  bool IsDue(const CommunicationMoment& moment);
  /// Expected edits, in cells, below which a view is not sent nevertheless.
  double least_information() const {
    return config_.policy == "threshold" ? config_.threshold_cells : 0.0;
  }
  double turn_cost() const { return config_.turn_cost; }

 private:
  CommunicationConfig config_;
  Random random_;
};

/// Nothing for policy "search".
std::optional<CommunicationPolicy> MakeCommunicationPolicy(const CommunicationConfig& config,
                                                           std::uint64_t seed);

/// The views of the situation's camera in `headings` directions, as far as `range_cells`: `kept` if it
/// is of the same camera.
std::shared_ptr<const GridViews> ViewsFor(const Situation& situation, int headings,
                                          std::shared_ptr<const GridViews> kept = nullptr,
                                          double range_cells = GridViews::Options().range_cells);

/// How far the search relies on the operator.
struct Reliance {
  /// The information of a view is multiplied by this, in [0, 1].
  double information_weight = 1.0;
  /// Whether a path on which the robot knows of a wall, ahead of it or behind, still guides it; if
  /// not, it counts as none.
  bool blocked_path_guides = false;
  int believed_wall_steps = 1;  // of SearchProblem
  int off_guidance_steps = 1;   // the same
};

/// A robot's situation as the search sees it: the problem, and the graph of cells that it refers to.
class SituationProblem {
 public:
  /// `belief` is what the operator's map is taken to be, `withheld` views that are not offered.
  /// `views` stand for the situation's camera (ViewsFor).
  /// `steps` are of the robot's earlier problems.
  SituationProblem(const Situation& situation, SharedBelief belief, std::vector<SentView> withheld,
                   std::shared_ptr<const GridViews> views, const Reliance& reliance = {},
                   std::shared_ptr<GridSteps> steps = nullptr);
  /// The same on the graph of `regions`, which was brought up to the situation and outlives this.
  /// Information is map area in m2. A picture corrects at most what it shows and the operator's map has
  /// wrong, so views that can show less than `least_information` of that, by the robot's map and from
  /// as far as `view_range_cells`, count as worth nothing, without the model.
  SituationProblem(const Situation& situation, SharedBelief belief, std::vector<SentView> withheld,
                   const RegionNavigation& regions, const Reliance& reliance = {},
                   double view_range_cells = std::numeric_limits<double>::infinity(),
                   double least_information = 0.0);
  SituationProblem(const SituationProblem&) = delete;
  SituationProblem& operator=(const SituationProblem&) = delete;

  /// Null when the robot's cell cannot be free on its map, or a region has more neighbours than the
  /// search has actions.
  const SearchProblem* get() const { return problem_ ? &*problem_ : nullptr; }
  SearchProblem* get() { return problem_ ? &*problem_ : nullptr; }

 private:
  void Pose(const Situation& situation, const NavigationGraph& graph, VertexId start,
            std::vector<SentView> withheld, const Reliance& reliance);

  std::optional<GridGraph> cells_;
  SharedBelief belief_;
  std::optional<SearchProblem> problem_;
};

/// Pictures that change nothing, so that a search with this model moves for the task's sake alone;
/// for methods in which something else decides on pictures. Never fails.
class NoNewsModel final : public PerceptionModel {
 public:
  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  ModelIdentity identity() const override { return {"none", "", ""}; }
};

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
               std::optional<CommunicationPolicy> policy = std::nullopt);

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  void Prepare(const OccupancyGrid& map) override;
  std::vector<Cell> IntendedPathFor(const Situation& situation) override;
  AwaitedInput awaits() const override { return AwaitedInput::kAnswers; }

 private:
  /// The view that the last decision asked for; it counts as sent when the robot shows one more
  /// snapshot.
  struct ChosenView {
    SentViews::View view;
    VisibleCells visible;
    std::vector<Cell> path;  // tau at that time
    SharedBelief belief;
    std::uint64_t snapshots_before = 0;
    bool asks_for_way = false;
  };

  /// When the world restarted with a map of another size, pictures and measurements of the old one
  /// no longer count.
  void ForgetOtherSize(const OccupancyGrid& map);
  void NoteSentView(const Situation& situation);
  /// Asks what edits the picture of `chosen`, which was sent, will lead to; their model learns of them
  /// at the next decision.
  void ExpectEdits(const ChosenView& chosen);
  /// The same one as long as it does not change.
  SharedBelief BeliefOf(const Situation& situation);
  SituationProblem ProblemOf(const Situation& situation, const SharedBelief& belief);
  double ViewRange() const;
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
  void TakeRoute(const Situation& situation, Decision& decision) const;
  Decision FromPolicy(const BestView& view, const Situation& situation);
  /// Makes `decision` the one to send a view.
  void Send(double heading_rad, double information, const Situation& situation, Decision& decision);

  SearchConfig config_;
  std::shared_ptr<PerceptionModel> model_;
  std::optional<CommunicationPolicy> policy_;  // none: the search decides
  NoNewsModel no_news_;                        // what it plans with where it does not
  ParallelSearch search_;
  std::vector<SearchMemory> memories_;  // by tree
  std::shared_ptr<const GridViews> views_;
  std::optional<RegionNavigation> regions_;  // none: the search goes from cell to cell
  Random random_;
  const Clock& clock_;                        // of the search's wall time budget
  std::shared_ptr<BeliefEstimate> estimate_;  // may be null
  SharedBelief belief_;                       // the published one
  std::shared_ptr<GridSteps> steps_;
  std::optional<OperatorReliability> reliability_;  // none where it is not measured
  SentViews sent_views_;
  HiddenGoals hidden_goals_;
  AnswerTrust answer_trust_;
  std::optional<ChosenView> chosen_view_;
  std::optional<PerceptionQuery> sent_;  // the picture since the last decision
  std::pair<int, int> map_size_;         // rows and columns at the last decision
  LogLimit no_decision_;
  Patience patience_{clock_};
};

}  // namespace conav::planner
