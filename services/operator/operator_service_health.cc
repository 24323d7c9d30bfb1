#include <fmt/format.h>

#include "operator/operator_links.h"

namespace conav::operators {

Health OperatorService::Report() const {
  Health health{Health::Level::kOk, "serving", {}};
  for (const auto& world : worlds_) {
    const Belief* belief = store_.FindBelief(world->name);
    if (!world->served() && health.level == Health::Level::kOk) {
      health.level = Health::Level::kWarning;
      health.message = fmt::format("waiting for the initial map of world {}", world->name);
    }
    if (!world->refusal.empty()) {
      health.level = Health::Level::kError;
      health.message = world->refusal;
    }
    health.values.emplace_back(fmt::format("{} belief revision", world->name),
                               belief == nullptr ? "none" : std::to_string(belief->revision));
  }
  for (const auto& robot : robots_) {
    const Guidance* guidance = store_.FindGuidance(robot->name);
    health.values.emplace_back(fmt::format("{} guidance revision", robot->name),
                               std::to_string(guidance == nullptr ? 0 : guidance->revision));
    health.values.emplace_back(fmt::format("{} attention requests", robot->name),
                               std::to_string(robot->asked));
    const std::string driver = drive_gate_.DriverOf(robot->name, clock_.Now());
    health.values.emplace_back(fmt::format("{} steered by", robot->name),
                               driver.empty() ? "nobody" : driver);
  }
  health.values.emplace_back("matters in the attention queue",
                             std::to_string(attention_.items().size()));
  health.values.emplace_back("requests accepted", std::to_string(journal_.accepted()));
  health.values.emplace_back("requests refused", std::to_string(journal_.refused()));
  if (segments_) {
    health.values.emplace_back("segments recorded", std::to_string(segments_->recorded()));
    health.values.emplace_back("segments lost", std::to_string(segments_->lost()));
    health.values.emplace_back("pictures lost", std::to_string(segments_->lost_pictures()));
  }
  if (storage_failure_ && !storage_failure_->empty()) {
    health.level = Health::Level::kError;
    health.message = *storage_failure_;
  }
  return health;
}

}  // namespace conav::operators
