#pragma once

#include <cstddef>
#include <string>

#include "common/msg/supervision.h"

namespace conav::operators {

/// A line of the command log: what `request` asked for, in words, and how it was decided.
/// `stamp`: simulation time of its world.
OperatorEvent EventOf(const OperatorRequest& request, const OperatorReply& reply, SimTime stamp);

/// 0 cells: the path was removed.
std::string PathText(std::size_t cells);

}  // namespace conav::operators
