#include "bench/nhpm/planner_queries.h"

#include "common/msg/perception_model.h"
#include "planner/methods/ig_mcts_method.h"
#include "study/experiment/search_experiment.h"

namespace conav::bench {
namespace {

/// Passes questions on and keeps them.
class Recorder final : public PerceptionModel {
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

}  // namespace

QueryBatches RecordPlannerQueries(int episodes, std::uint64_t first_seed) {
  const auto recorder = std::make_shared<Recorder>();
  const SteadyClock clock;
  for (int i = 0; i < episodes; ++i) {
    sim::WorldOptions world;
    world.seed = first_seed + static_cast<std::uint64_t>(i);
    planner::IgMctsMethod method({}, world.seed, recorder, clock);
    planner::RunEpisode(sim::MakeWorldSpec(world).value(), method, {}, world.seed);
  }
  return recorder->Take();
}

}  // namespace conav::bench
