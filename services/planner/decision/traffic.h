#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "common/runtime/random.h"
#include "planner/decision/method.h"

namespace conav::planner {

/// Several robots in corridors one cell wide, each decided for by itself. The right of way: a robot
/// with goals left goes before one without, then names in order. Whoever stands on the way of a
/// robot that goes before it makes room; whoever goes before waits a moment for that, and looks for
/// another way if nothing happens.

/// Wall time for which a robot waits for another one to make room, before it tries something else.
inline constexpr std::chrono::milliseconds kPatience{500};

/// Whether another robot stands on `cell`.
bool IsTaken(const Situation& situation, Cell cell);

/// Cells that the robot would enter next if no other robot were there: the shortest way over what
/// is not known to be a wall to its nearest goal; empty without goals. The others hear of it and
/// make room.
std::vector<Cell> DesiredWay(const Situation& situation);

/// The step that makes room: towards the nearest known free cell that is on no way of a robot that
/// goes before this one, if this robot stands within the next few cells of such a way. Otherwise, if
/// a robot on the first cell of `own_way` would have to make room and this one shuts it in, a step
/// back out of its dead end. Nothing when there is no need, or no room.
std::optional<Cell> StepAside(const Situation& situation, const std::vector<Cell>& own_way);

/// A free neighbour cell drawn at random: the last resort of robots that wait for each other.
std::optional<Cell> StepAnywhere(const Situation& situation, Random& random);

/// The neighbour to wait for before this robot enters the first cell of `way`: one that has to make
/// room and stands there, or stands on the next few cells and would be shut in. Null if none.
const Neighbour* WaitsFor(const Situation& situation, const std::vector<Cell>& way);

}  // namespace conav::planner
