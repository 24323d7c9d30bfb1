#pragma once

#include <cstddef>
#include <string>

#include "common/msg/supervision.h"

namespace conav::operators {

/// A line of the command log: what `request` asked for, in words, and how it was decided.
/// `stamp`: simulation time of its world.
OperatorEvent EventOf(const OperatorRequest& request, const OperatorReply& reply, SimTime stamp);

/// Low-level actions and selections are void as soon as they are old, and are not stored.
bool IsStored(const OperatorRequest& request);
/// The robot of a request that guides or answers; null for others.
const std::string* GuidedRobot(const OperatorRequest& request);
/// Edits, guides or answers.
bool NeedsMap(const OperatorRequest& request);

/// 0 cells: the path was removed.
std::string PathText(std::size_t cells);

}  // namespace conav::operators
