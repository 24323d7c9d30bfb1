#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/msg/robot.h"
#include "common/runtime/clock.h"
#include "common/service/diagnostics.h"
#include "operator/config.h"
#include "operator/console/console_topics.h"
#include "operator/foxglove/foxglove_server.h"
#include "operator/recording/raw_topics.h"
#include "operator/supervision/control.h"
#include "operator/supervision/supervision_topics.h"

// One user: the service; apart because it knows the bus.

namespace conav::foxglove {

/// What Foxglove is shown and may ask for: docs/ros2.md.
///
/// Channels are all topics of the supervised robots, of their worlds and of the system, subscribed
/// to on the bus while a client subscribes to them. Services are /<robot>/stop and /<robot>/resume:
/// requests like those of a page, with the role of the client's token, answered by the same code. A
/// goal is published on /<robot>/goal_pose for a client that may command the robot. Parameters are
/// the service's options, as they are; none may be set. The connection graph is the topic table's,
/// of the processes that report on /diagnostics. Assets are package://conav/<robot>.urdf, from
/// /<robot>/robot_description.
/// Threads: one, the service's; the server has its own.
class FoxgloveTopics {
 public:
  /// `participant` and `clock` outlive it. Throws StartupError as FoxgloveServer does, and with a
  /// task, whose participant must not see the true maze.
  FoxgloveTopics(bus::Participant& participant, const operators::OperatorConfig& config,
                 const Clock& clock);
  ~FoxgloveTopics();

  /// Receives what arrived, and publishes goals. `now`: the operator's time. Returns what goes to
  /// the service's own code, in order of arrival.
  std::vector<operators::ConsoleTopics::Asked> Step(const operators::ControlRegistry& control,
                                                    SimTime now);
  /// The health of the processes, by name.
  void Receive(const std::map<std::string, operators::ServiceStatus>& services);
  void AddTo(Health& health) const;
  std::string url() const { return server_->url(); }

 private:
  struct RobotLink;
  struct PendingAsset;

  void FollowSubscriptions();
  void Publish(const ClientRequest& request, const PublishGoal& goal,
               const operators::ControlRegistry& control);
  operators::ConsoleTopics::Asked Read(const ClientRequest& request, const CallService& call,
                                       SimTime now);
  void Fetch(const ClientRequest& request, const FetchAsset& fetch);
  void AnswerAssets();
  void Complain(std::uint64_t client, const std::string& message);

  bus::Participant& participant_;
  const Clock& clock_;
  std::vector<recorder::RawTopic> topics_;  // channel id - 1
  std::vector<std::unique_ptr<RobotLink>> robots_;
  std::vector<std::string> service_names_;  // service id - 1
  std::uint64_t last_request_id_ = 0;
  ConnectionGraph graph_;
  std::unique_ptr<FoxgloveServer> server_;  // outlives the readers, which put messages there
  std::map<std::uint32_t, std::unique_ptr<bus::Reader>> readers_;  // by channel
  std::vector<std::unique_ptr<PendingAsset>> assets_;
};

}  // namespace conav::foxglove
