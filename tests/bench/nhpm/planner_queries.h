#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/msg/perception_model.h"
#include "planner/methods/ig_mcts_method.h"
#include "study/experiment/search_experiment.h"

namespace conav::bench {

/// Batches in the order asked.
using QueryBatches = std::vector<std::vector<PerceptionQuery>>;

/// Passes questions on and keeps them.
class QueryRecorder final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    if (!queries.empty()) batches_.emplace_back(queries.begin(), queries.end());
    return model_.Predict(queries);
  }
  ModelIdentity identity() const override { return model_.identity(); }
  QueryBatches Take() { return std::move(batches_); }

 private:
  FakePerceptionModel model_;
  QueryBatches batches_;
};

/// What the planner's search really asks: the batches of whole episodes of the default search in
/// mazes of 13 x 13 cells (seeds `first_seed` and the next ones), in process, with a fake model and
/// a simulated operator.
inline QueryBatches RecordPlannerQueries(int episodes, std::uint64_t first_seed) {
  const auto recorder = std::make_shared<QueryRecorder>();
  const SteadyClock clock;
  const operators::SyntheticOperatorParameters person;
  for (int i = 0; i < episodes; ++i) {
    sim::WorldOptions world;
    world.seed = first_seed + static_cast<std::uint64_t>(i);
    planner::IgMctsMethod method({}, world.seed, recorder, clock);
    planner::RunEpisode(sim::MakeWorldSpec(world).value(), method, person, world.seed);
  }
  return recorder->Take();
}

}  // namespace conav::bench
