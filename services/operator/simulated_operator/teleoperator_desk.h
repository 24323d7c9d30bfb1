#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/subscriber.h"
#include "common/runtime/clock.h"
#include "operator/client/operator_client.h"
#include "operator/simulated/synthetic_teleoperator.h"

namespace conav::operators {

/// A synthetic teleoperator on the bus: hears what a console would show (the operator's map, where
/// the robots are on it, what their streamed pictures show) and sends keys and edits through
/// `client`, one at a time. Publishes nothing before all of that is there for each robot.
/// Threads: one.
class TeleoperatorDesk {
 public:
  TeleoperatorDesk(bus::Participant& participant, const Clock& clock, OperatorClient& client,
                   const SyntheticOperatorParameters& parameters, std::uint64_t seed,
                   const std::map<std::string, std::string>& world_of_robot);
  ~TeleoperatorDesk();

  /// Takes in everything that arrived and asks what is to be asked. Does not block.
  void Step();

  const SyntheticTeleoperator& person() const { return person_; }

 private:
  struct RobotLink;
  struct WorldLink;

  void TakeIn();

  const Clock& clock_;
  OperatorClient& client_;
  SyntheticTeleoperator person_;
  std::vector<std::unique_ptr<WorldLink>> worlds_;
  std::vector<std::unique_ptr<RobotLink>> robots_;
};

}  // namespace conav::operators
