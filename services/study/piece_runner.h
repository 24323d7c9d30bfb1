#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "common/cli/progress_line.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"

/// Runs the pieces of a command (episodes, trials, mazes), several at once. record_store.h adds
/// records that outlive the command.
namespace conav::study {

struct PieceProgress {
  std::size_t ran = 0;     // since the start of this program
  std::size_t done = 0;    // of `of`, including those of earlier runs
  std::size_t failed = 0;  // of those that ran, after the last attempt
  std::size_t of = 0;
};
using PieceListener = std::function<void(const PieceProgress&)>;

/// Stores what a piece gave; true if the piece failed. Errors end the command.
using StorePiece = std::function<Result<bool>()>;

/// Plays piece `index`; empty if it was interrupted. `job` is in [0, jobs); each job plays one piece
/// at a time, job 0 on the caller's thread. Must not throw on another job.
using PlayPiece = std::function<StorePiece(int job, std::size_t index)>;

/// Plays the `pending` ones of `of` pieces in order, `jobs` at a time. Each is stored before the
/// next piece of its job begins; only one thread at a time stores, and calls `listener`.
/// Ends early when `stop` is requested, or with the error of a piece that cannot be stored.
[[nodiscard]] Result<void> RunPieces(const std::vector<std::size_t>& pending, std::size_t of,
                                     int jobs, const PlayPiece& play, const StopToken& stop,
                                     const PieceListener& listener);

/// When a progress line is shown again.
enum class ProgressPace { kEachPiece, kNowAndThen };

/// "37 of 126 episodes, 1 failed, 2:10 left"; `pieces` is "episodes". `line` outlives it.
PieceListener ShowOn(ProgressLine& line, const std::string& pieces,
                     ProgressPace pace = ProgressPace::kEachPiece);

}  // namespace conav::study
