#include "planner/make_perception.h"

#include "common/runtime/log.h"
#include "planner/perception/embedded_perception_model.h"
#include "planner/perception/fallback_perception_model.h"
#include "planner/perception/remote_perception_model.h"

namespace conav::planner {
namespace {

void ReportSwitch(const std::optional<Error>& why) {
  if (why) {
    LOG_WARNING("perception service gone, using the embedded GLPF", "reason", why->text);
  } else {
    LOG_INFO("perception service is back");
  }
}

}  // namespace

std::shared_ptr<PerceptionModel> MakePerception(bus::Participant& participant,
                                                const PlannerConfig& config, const Clock& clock) {
  auto embedded = std::make_shared<EmbeddedPerceptionModel>();
  if (config.perception == "embedded") return embedded;
  RemotePerceptionModel::Options options;
  options.timeout = Seconds(config.perception_timeout_s);
  return std::make_shared<FallbackPerceptionModel>(
      std::make_shared<RemotePerceptionModel>(participant, options), std::move(embedded),
      FallbackPerceptionModel::Options{}, clock, ReportSwitch);
}

}  // namespace conav::planner
