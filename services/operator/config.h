#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/msg/method.h"
#include "common/runtime/config.h"
#include "common/service/robot_list.h"
#include "operator/console/participant_task.h"
#include "operator/gateway/access.h"
#include "operator/recording/segment_collector.h"
#include "operator/supervision/attention_queue.h"
#include "operator/supervision/control.h"
#include "operator/supervision/field_goals.h"

namespace conav::operators {

/// Section `operator:` of a config file.
struct OperatorConfig {
  bus::ParticipantOptions bus;
  /// "world/robot" of every robot that is supervised here.
  std::vector<std::string> robots{"w1/r1"};  // [] for a form or a rest (TaskOptions)
  /// SQLite file of the beliefs, guidance and requests; made when it does not exist, its folder
  /// must. A second start with the same file goes on where the first one ended; a world
  /// that begins with another map than the stored one is refused.
  std::string database = "operator.db";
  /// Refuse requests rather than grow beyond this; 0 = until the disk is full.
  double database_limit_mib = 0.0;
  /// Longest time (simulation) for which a client may give guidance.
  double max_guidance_s = 7200.0;
  /// Longest path of guidance.
  int max_path_cells = 10000;
  /// What the planners run, for the console; none = it finds out from their first report.
  std::optional<MethodKind> method;
  AttentionOptions attention;
  SegmentOptions recording;
  ControlOptions control;
  GoalOptions goals;
  TaskOptions task;
  GatewayOptions console;
  FoxgloveOptions foxglove;

  /// `robots`, robot -> world. Throws StartupError.
  std::map<std::string, std::string> world_of_robot() const {
    const bool needs_none = task.on() && !task.is_maze();
    return WorldOfRobot("operator", robots, needs_none ? NoRobots::kAllowed : NoRobots::kRefused);
  }

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("robots", robots);
    reader.Field("database", database);
    reader.Field("database_limit_mib", database_limit_mib, 0.0, 1e6);
    reader.Field("max_guidance_s", max_guidance_s, 1.0, 1e6);
    reader.Field("max_path_cells", max_path_cells, 1, 65536);
    reader.Choice("method", method, kMethods);
    reader.Section("attention", attention);
    reader.Section("recording", recording);
    reader.Section("control", control);
    reader.Section("goals", goals);
    reader.Section("task", task);
    reader.Section("console", console);
    reader.Section("foxglove", foxglove);
  }
};

}  // namespace conav::operators
