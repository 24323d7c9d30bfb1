#include "planner/search/reward.h"

#include <array>
#include <cmath>

#include "common/runtime/config.h"

namespace conav::planner {

void RewardOptions::Visit(ConfigReader& reader) {
  reader.Field("goal", goal, 0.0, 1e6);
  reader.Field("step", step, -1e6, 0.0);
  reader.Field("communication_cost", communication_cost, 0.0, 1e6);
  reader.Field("communication_step", communication_step, -1e6, 0.0);
  reader.Field("progress", progress, 0.0, 1e6);
}

namespace {

/// log n for the n that occur; std::log for others.
class LogTable {
 public:
  LogTable() {
    for (std::size_t n = 1; n < values_.size(); ++n) values_[n] = std::log(static_cast<double>(n));
  }
  double Of(int n) const {
    const auto index = static_cast<std::size_t>(n);
    return index < values_.size() ? values_[index] : std::log(static_cast<double>(n));
  }

 private:
  std::array<double, 1024> values_{};
};

const LogTable kLog;

}  // namespace

double GuidanceReward(bool guided_before, bool on_guidance, int path_length) {
  if (!guided_before || on_guidance) return 0.0;
  return -kLog.Of(path_length);
}

double CommunicationReward(const PathState& path, double information,
                           const RewardOptions& options) {
  return information - CommunicationCost(path.unvisited_guidance(), options) +
         options.communication_step;
}

}  // namespace conav::planner
