#pragma once

#include <optional>
#include <vector>

#include "common/runtime/random.h"
#include "planner/method.h"

namespace conav::planner {

/// Several robots in corridors one cell wide, each decided for by itself. The right of way: a robot
/// with goals left goes before one without, then names in order. Whoever stands on the way of a
/// robot that goes before it makes room; whoever goes before waits a moment for that, and looks for
/// another way if nothing happens.

/// Cells that the robot would enter next if no other robot were there: the shortest way over what
/// is not known to be a wall to its nearest goal; empty without goals. The others hear of it and
/// make room.
std::vector<Cell> DesiredWay(const Situation& situation);

/// The first step towards the nearest known free cell that is on no way of a robot that goes before
/// this one, if this robot stands within the next few cells of such a way. Nothing when it stands
/// on none, or cannot get away.
std::optional<Cell> StepAside(const Situation& situation);

/// A free neighbour cell drawn at random: the last resort of robots that wait for each other.
std::optional<Cell> StepAnywhere(const Situation& situation, Random& random);

/// The neighbour that stands on the first cell of `way` and has to make room for this robot, if
/// any.
const Neighbour* WaitsFor(const Situation& situation, const std::vector<Cell>& way);

}  // namespace conav::planner
