#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/protocol/supervision.h"
#include "console.pb.h"

/// What lines of the command log say, live and in a replay.
namespace conav::operators {

/// Without its id and times.
console::Event EventOf(const OperatorRequest& request, const OperatorReply& reply);

std::string EditText(std::size_t cells);
/// 0 cells: the path was taken back.
std::string PathText(std::size_t cells);
/// "Nothing new here".
std::string AnswerText(std::uint64_t snapshot);
/// No robots: all of them.
std::string StopText(const std::vector<std::string>& robots, const std::string& reason);
std::string GoText(const std::vector<std::string>& robots);

}  // namespace conav::operators
