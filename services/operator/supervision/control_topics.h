#pragma once

#include <map>
#include <memory>
#include <string>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/msg/supervision.h"
#include "common/runtime/clock.h"
#include "operator/belief/belief_store.h"
#include "operator/config.h"
#include "operator/supervision/control.h"

// One user: the service; apart because it knows the bus.

namespace conav::operators {

/// Control and stops of robots (ControlRegistry): on disk first, then on the bus. After a restart
/// stopped robots stay stopped; nobody has control.
///
/// Publishes a robot's newest stop order at once, when there is one.
/// Threads: one, the service's.
class ControlTopics {
 public:
  /// All outlive it.
  ControlTopics(bus::Participant& participant, const OperatorConfig& config, BeliefStore& store,
                const Clock& clock);

  static bool Handles(const OperatorRequest& request);
  /// Requires Handles(request), and that it is no repeat. `now`: the operator's time.
  BeliefStore::Answer Answer(const OperatorRequest& request, SimTime now);
  /// Why another client's control forbids `request`; empty = it does not.
  std::string CheckAllowed(const OperatorRequest& request) const;
  /// A request of `client` was not refused because of another client's control.
  void Renew(const std::string& client) { registry_.Renew(client, clock_.Now()); }
  void Leave(const std::string& client) { registry_.ReleaseAll(client); }
  void Step() { registry_.Expire(clock_.Now()); }

  const ControlRegistry& registry() const { return registry_; }

 private:
  using StopPublisher = bus::Publisher<conav_msgs::msg::StopOrder>;

  Result<std::vector<StopOrder>> Decide(const OperatorRequest& request, SimTime now,
                                        ControlRegistry& registry) const;
  void Publish(const StopOrder& order);

  BeliefStore& store_;
  const Clock& clock_;
  ControlRegistry registry_;
  std::map<std::string, std::unique_ptr<StopPublisher>> stops_;  // by robot
};

}  // namespace conav::operators
