#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/msg/supervision.h"
#include "console.pb.h"

namespace conav::operators {

/// How many cells fit into one Request of a page (idl/console.proto).
struct RequestLimits {
  std::uint32_t edit_cells = 0;
  std::uint32_t path_cells = 0;
  bool operator==(const RequestLimits&) const = default;
};

/// `message_bytes`: the longest message that is taken. `most`: what else limits them.
RequestLimits LimitsOf(std::size_t message_bytes, RequestLimits most);

}  // namespace conav::operators

/// The texts of the command log, live and in a replay.
namespace conav::operators {

/// Without its id and times.
console::Event EventOf(const OperatorRequest& request, const OperatorReply& reply);

std::string EditText(std::size_t cells);
/// 0 cells: the path was removed.
std::string PathText(std::size_t cells);
/// "Nothing new here".
std::string AnswerText(std::uint64_t snapshot);
/// No robots: all of them.
std::string StopText(const std::vector<std::string>& robots, const std::string& reason);
std::string ResumeText(const std::vector<std::string>& robots);
std::string GoalsText(std::size_t added, std::size_t removed);

}  // namespace conav::operators
