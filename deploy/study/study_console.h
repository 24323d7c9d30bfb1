#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "common/console/progress_line.h"
#include "study/run_pieces.h"

/// What both studies tell their user while they run and when they cannot.
namespace conav::study {

/// "37 of 126 episodes, 1 failed, 2:10 left"; `pieces` is "episodes". `line` outlives it.
StudyListener ShowOn(ProgressLine& line, const std::string& pieces);

/// Prints `text` on standard output, or, where that holds the document of --json, on standard error.
/// Errors: kIo.
[[nodiscard]] Result<void> PrintTables(const std::string& text,
                                       const std::filesystem::path& json_file);

/// Prints why StudyFolder::Open did not give --out, and gives the exit code: 2 for kRefused, else 1.
int RefusedFolder(std::string_view program, const Error& error);

/// Prints how much there is and how to go on, and gives exit code 1. "2 of 60 episodes".
int Interrupted(std::string_view program, std::size_t done, std::size_t of,
                const std::string& pieces, const StudyFolder& folder);

}  // namespace conav::study
