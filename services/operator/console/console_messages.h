#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/protocol/planning.h"
#include "common/protocol/robot.h"
#include "common/protocol/supervision.h"
#include "console.pb.h"
#include "operator/alerts/alert.h"
#include "operator/task/participant_task.h"

/// Domain values as idl/console.proto has them. `heard_at_s`: wall time of the service, s since 1970.
namespace conav::operators {

/// What a page is shown of: `robots` are entries "world/robot" as WorldOfRobot takes them, and keep
/// their order; worlds are in that of their names.
console::Session SessionOf(const std::vector<std::string>& robots, const std::string& method);

console::Cell ToConsole(Cell cell);
void AddCells(std::span<const Cell> cells, google::protobuf::RepeatedPtrField<console::Cell>* to);

console::Robot ToConsole(const RobotState& state, double heard_at_s);
/// 255 * P(wall), row-major.
std::string ToBytes(const Grid<float>& probabilities);
/// 0 unknown, 1 free, 2 wall, row-major.
std::string ToBytes(const OccupancyGrid& cells);
console::Guidance ToConsole(const Guidance& guidance);
/// Without an answer.
console::Picture ToConsole(const Picture& picture, double heard_at_s);
console::Search ToConsole(const SearchReport& report);
console::Alert ToConsole(const Alert& alert);
console::Task ToConsole(const TaskStatus& task);
console::Attention ToConsole(const AttentionQueueState& queue);

}  // namespace conav::operators
