#pragma once

#include <memory>
#include <string>

#include "common/bus/participant.h"
#include "common/runtime/clock.h"
#include "planner/config.h"
#include "planner/search/perception_model.h"

namespace conav::planner {

/// The perception models of a planner, as its config asks for: the nhpm service or a model in this
/// process, with the embedded GLPF to fall back on.
class PerceptionSetup {
 public:
  /// `participant` and `clock` outlive it. Throws StartupError when the embedded model's weights
  /// cannot be read.
  PerceptionSetup(bus::Participant& participant, const PlannerConfig& config, const Clock& clock);

  /// For the robots of one world. Each world has its own memory of answers and its own state of
  /// fallback, because maps of different worlds may differ in size and a network may be made for
  /// one. Falling back and coming back are logged, with `world`.
  std::shared_ptr<PerceptionModel> ForWorld(const std::string& world) const;

 private:
  const Clock& clock_;
  bool needs_fallback_;
  std::shared_ptr<PerceptionModel> primary_;
  std::shared_ptr<PerceptionModel> glpf_;
};

}  // namespace conav::planner
