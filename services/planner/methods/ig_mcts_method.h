#pragma once

#include <cstdint>
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
#include "planner/methods/method_config.h"
#include "planner/methods/operator_model.h"
#include "planner/search/parallel_search.h"
#include "planner/search/search_problem.h"
#include "planner/search/view_information.h"

namespace conav::planner {

/// What a rule may look at when it decides whether a picture is sent now.
struct CommunicationMoment {
  int moves_since_picture = 0;  // since the start, before the first one
  bool sent_before = false;
  bool guidance_fails = false;  // GuidanceFails()
};

/// Whether the operator's path no longer leads the robot on: a known wall lies on what is left of
/// it, the robot is beside it or at its end, or it expired. Without any path so far: no.
bool GuidanceFails(const Situation& situation);

CommunicationMoment MomentOf(const Situation& situation);

/// A rule that sends pictures in the place of the search, for comparison with it. The heading is
/// the one with the largest expected information, less what its turn costs, of those not sent yet.
/// Threads: one worker's.
class CommunicationPolicy {
 public:
  virtual ~CommunicationPolicy() = default;
  /// Whether a picture shall be sent before the next move. Asked once per decision.
  virtual bool Wants(const CommunicationMoment& moment) = 0;
  /// Expected edits, in cells, below which a view is not sent nevertheless.
  virtual double least_information() const { return 0.0; }
  /// CommunicationConfig::turn_cost, expected edits per radian.
  double turn_cost() const { return turn_cost_; }
  void set_turn_cost(double turn_cost) { turn_cost_ = turn_cost; }

 private:
  double turn_cost_ = 0.0;
};

class NeverPolicy final : public CommunicationPolicy {
 public:
  bool Wants(const CommunicationMoment&) override { return false; }
};

/// With a fixed probability, drawn at each decision.
class RandomPolicy final : public CommunicationPolicy {
 public:
  RandomPolicy(double probability, std::uint64_t seed) : probability_(probability), random_(seed) {}
  bool Wants(const CommunicationMoment&) override { return random_.Chance(probability_); }

 private:
  double probability_;
  Random random_;
};

/// After every so many moves.
class EveryMovesPolicy final : public CommunicationPolicy {
 public:
  explicit EveryMovesPolicy(int moves) : moves_(moves) {}
  bool Wants(const CommunicationMoment& moment) override {
    return moment.moves_since_picture >= moves_;
  }

 private:
  int moves_;
};

/// When the operator's path fails; once per place, as one who has answered has no better one.
class WhenBlockedPolicy final : public CommunicationPolicy {
 public:
  bool Wants(const CommunicationMoment& moment) override {
    return moment.guidance_fails && (moment.moves_since_picture > 0 || !moment.sent_before);
  }
};

/// Whenever the best view is worth it.
class ThresholdPolicy final : public CommunicationPolicy {
 public:
  explicit ThresholdPolicy(double cells) : cells_(cells) {}
  bool Wants(const CommunicationMoment&) override { return true; }
  double least_information() const override { return cells_; }

 private:
  double cells_;
};

/// Null for policy "search".
std::unique_ptr<CommunicationPolicy> MakeCommunicationPolicy(const CommunicationConfig& config,
                                                             std::uint64_t seed);

/// The views of the situation's camera in `headings` directions: `kept` if it is of the same
/// camera.
std::shared_ptr<const GridViews> ViewsFor(const Situation& situation, int headings,
                                          std::shared_ptr<const GridViews> kept = nullptr);

/// How far the search relies on the operator.
struct Reliance {
  /// What a view tells the operator is multiplied by this, in [0, 1].
  double information_weight = 1.0;
  /// Whether a path on which the robot knows of a wall, ahead of it or behind, still guides it; if
  /// not, it counts as none.
  bool blocked_path_guides = false;
};

/// A robot's situation as the search sees it: the problem and the graph that it refers to.
class SituationProblem {
 public:
  /// `belief` is what the operator's map is taken to be, `withheld` views that are not offered.
  /// `views` stand for the situation's camera (ViewsFor).
  SituationProblem(const Situation& situation, BeliefGrid belief, std::vector<SentView> withheld,
                   std::shared_ptr<const GridViews> views, const Reliance& reliance = {});
  SituationProblem(const SituationProblem&) = delete;
  SituationProblem& operator=(const SituationProblem&) = delete;

  /// Null when the robot's cell cannot be free on its map.
  const SearchProblem* get() const { return problem_ ? &*problem_ : nullptr; }

 private:
  GridGraph graph_;
  BeliefGrid belief_;
  std::optional<SearchProblem> problem_;
};

/// Remembers which views a robot has sent, and on what belief: none is offered again while the
/// operator's map is unchanged in the cells that it shows, because the same picture would change
/// nothing the second time. Without this rule the reward lets the planner send one view for ever
/// (facts measured in the search experiment).
class SentViews {
 public:
  struct View {
    Cell cell;
    double heading_rad = 0.0;
    bool operator==(const View&) const = default;
  };

  /// The robot sends this view now. Its belief is taken at the next Update(), after the operator's
  /// answer.
  void Sent(const View& view, VisibleCells visible);

  /// The belief as it is at the next decision: views whose cells changed since are offered again.
  void Update(const BeliefGrid& belief);

  /// Views that must not be offered now.
  std::vector<View> Withheld() const;

 private:
  struct Entry {
    View view;
    std::vector<Cell> cells;
    std::vector<float> belief;  // of `cells` after the answer; empty until then
  };

  std::vector<Entry> entries_;
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
               std::unique_ptr<CommunicationPolicy> policy = nullptr);

  Decision Decide(const Situation& situation, const StopToken& stop) override;
  std::vector<Cell> IntendedPathFor(const Situation& situation) override;
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
  ParallelSearch search_;
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
