#include "bench/nhpm/planner_queries.h"

#include "planner/search/fake_perception_model.h"
#include "unit/planner/search/closed_loop.h"

namespace conav::bench {
namespace {

/// Passes questions on and keeps them.
class Recorder final : public planner::PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery> queries) override {
    if (!queries.empty()) batches_.emplace_back(queries.begin(), queries.end());
    return model_.Predict(queries);
  }
  std::string name() const override { return model_.name(); }
  QueryBatches Take() { return std::move(batches_); }

 private:
  planner::FakePerceptionModel model_;
  QueryBatches batches_;
};

}  // namespace

QueryBatches RecordPlannerQueries(int episodes, std::uint64_t seed) {
  constexpr int kSize = 13;
  constexpr int kWrongCells = 20;
  Recorder recorder;
  for (int i = 0; i < episodes; ++i) {
    const std::uint64_t episode_seed = DeriveSeed(seed, static_cast<std::uint64_t>(i));
    planner::closed_loop::RunEpisode(
        planner::closed_loop::MakeWorld(episode_seed, kSize, kWrongCells), {}, recorder,
        episode_seed);
  }
  return recorder.Take();
}

}  // namespace conav::bench
