#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "mapping_task/task_options.h"

namespace conav::mapping_task {

/// How a maze went, as its operator service wrote it down.
struct MazeResult {
  double mapping_accuracy = 0.0;
  nlohmann::ordered_json document;  // the whole file
};

/// Nothing when there is no such file yet. Errors: kIo; kMalformed names the file.
[[nodiscard]] Result<std::optional<MazeResult>> ReadMazeResult(const std::filesystem::path& file);

/// result.json of the task: whether it is complete, the mean mapping accuracy (what a bonus is paid
/// by), and each maze that was finished, with "valid" where its mapping accuracy is above
/// kAcceptedMappingAccuracy. `results`: those of the first mazes.
nlohmann::ordered_json TaskJson(const TaskOptions& options, const std::vector<MazeResult>& results);

/// A line for the terminal.
std::string MazeLine(int number, const MazeResult& result);

}  // namespace conav::mapping_task
