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

namespace conav::operators {

/// The operator service's word on who commands which robot, and which robots stand (ControlBook): on
/// disk first, then on the bus. After a restart stopped robots stay stopped; control is taken anew.
///
/// Publishes a robot's newest hold order at once, when there is one.
/// Threads: one, the service's.
class ControlDesk {
 public:
  /// All outlive it.
  ControlDesk(bus::Participant& participant, const OperatorConfig& config, BeliefStore& store,
              const Clock& clock);

  static bool Handles(const OperatorRequest& request);
  /// Requires Handles(request), and that it is no repeat. `now`: the operator's time.
  BeliefStore::Answer Answer(const OperatorRequest& request, SimTime now);
  /// Why another client's control forbids `request`; empty = it does not.
  std::string WhyNot(const OperatorRequest& request) const;
  /// `client` asked for something, whatever it is, that was not refused for want of control.
  void Renew(const std::string& client) { book_.Renew(client, clock_.Now()); }
  void Leave(const std::string& client) { book_.ReleaseAll(client); }
  void Step() { book_.Expire(clock_.Now()); }

  const ControlBook& book() const { return book_; }

 private:
  using HoldPublisher = bus::Publisher<conav_msgs::msg::HoldOrder>;

  Result<std::vector<HoldOrder>> Decide(const OperatorRequest& request, SimTime now,
                                        ControlBook& book) const;
  void Publish(const HoldOrder& order);

  BeliefStore& store_;
  const Clock& clock_;
  ControlBook book_;
  std::map<std::string, std::unique_ptr<HoldPublisher>> holds_;  // by robot
};

}  // namespace conav::operators
