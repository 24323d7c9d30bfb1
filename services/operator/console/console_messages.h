#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"
#include "common/msg/planning.h"
#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "console.pb.h"
#include "operator/belief/alert.h"

/// Domain values as messages of idl/console.proto, and these messages as bytes.
namespace conav::operators {

/// Nothing for what is no number, or not on the map.
std::optional<Cell> CellAt(Position position, const GridGeometry& grid);

/// Up to the first position that is not on the map, which no planner of ours sends; 10000 at most.
std::vector<Cell> CellsAt(std::span<const Position> positions, const GridGeometry& grid);

/// `update` as an element of console::Updates.update. An update is encoded once, however many pages
/// get it: encoded updates one behind the other are the body of a console::Updates.
std::string EncodeUpdate(const console::Update& update);

/// A console::ServerMessage with the updates of UpdateLog::Batch; `everything` as in the schema.
std::string EncodeUpdates(std::string_view updates, bool everything);

std::string Encode(const console::ServerMessage& message);

/// Errors: kMalformed.
[[nodiscard]] Result<console::ClientMessage> DecodeClientMessage(std::string_view bytes);

/// Also what follows from it: whether robots stream, and are driven by hand.
void SetMethod(const std::string& method, console::Session& session);

/// What a page is shown of: `robots` are entries "world/robot" as WorldOfRobot takes them, and keep
/// their order; worlds are in that of their names.
console::Session SessionOf(const std::vector<std::string>& robots, const std::string& method);

console::Cell ToConsole(Cell cell);
void AddCells(std::span<const Cell> cells, google::protobuf::RepeatedPtrField<console::Cell>* to);

/// `received_s`, here and below: wall time of the service, s since 1970.
console::Robot ToConsole(const RobotState& state, double received_s);
/// A grid as the schema packs it: 255 * P(wall).
std::string Packed(const Grid<float>& probabilities);
/// The same: 0 unknown, 1 free, 2 wall.
std::string Packed(const OccupancyGrid& cells);
console::Guidance ToConsole(const Guidance& guidance);
/// Without an answer.
console::Snapshot ToConsole(const Snapshot& snapshot, double received_s);
console::Search ToConsole(const SearchReport& report);
console::Alert ToConsole(const Alert& alert);
console::Attention ToConsole(const AttentionQueueState& queue);
/// Without its id. `time_s`: wall time, s since 1970.
console::Event ToConsole(const OperatorEvent& event, double time_s);

/// How many cells fit into one Request of a page (idl/console.proto).
struct RequestLimits {
  std::uint32_t edit_cells = 0;
  std::uint32_t path_cells = 0;
  bool operator==(const RequestLimits&) const = default;
};

/// `message_bytes`: the longest message that is taken. `most`: what else limits them.
RequestLimits LimitsOf(std::size_t message_bytes, RequestLimits most);

/// Converts a page's request into the OperatorRequest that a client on the bus sends, and checks it
/// as such (Checked() in common/msg/supervision.h).
/// Errors: kMalformed names the field, the value and the limit.
[[nodiscard]] Result<OperatorRequest> ToOperatorRequest(const console::Request& request,
                                                        const std::string& client, SimTime now);

}  // namespace conav::operators
