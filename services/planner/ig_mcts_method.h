#pragma once

#include <memory>
#include <string>

#include "common/runtime/random.h"
#include "planner/config.h"
#include "planner/method.h"
#include "planner/search/ig_mcts.h"
#include "planner/sent_views.h"

namespace conav::planner {

/// The robot decides by IG-MCTS: moves by itself, and sends the picture that is worth the
/// operator's attention. It never waits for guidance; the newest path is taken into account at each
/// decision.
class IgMctsMethod final : public Method {
 public:
  IgMctsMethod(const SearchConfig& config, std::uint64_t seed,
               std::shared_ptr<PerceptionModel> model);

  Decision Decide(const Situation& situation) override;
  bool pictures_are_answered() const override { return true; }

 private:
  /// A step aside, or a moment of waiting, when other robots are in the way.
  std::optional<Decision> MindTraffic(const Situation& situation);
  Decision FromResult(const SearchResult& result, const Situation& situation);

  SearchConfig config_;
  std::shared_ptr<PerceptionModel> model_;
  IgMcts search_;
  Random random_;
  SteadyClock clock_;  // of the search's wall time budget
  SentViews sent_views_;
  std::optional<Clock::TimePoint> waiting_since_;  // for another robot to make room
};

}  // namespace conav::planner
