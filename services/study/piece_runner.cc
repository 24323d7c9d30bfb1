#include "study/piece_runner.h"

#include <fmt/core.h>

#include <chrono>
#include <mutex>

namespace conav::study {

Result<void> RunPieces(const std::vector<std::size_t>& pending, std::size_t of, int jobs,
                       const PlayPiece& play, const StopToken& stop,
                       const PieceListener& listener) {
  PieceProgress progress{.done = of - pending.size(), .of = of};
  std::mutex mutex;  // guards progress, failure, storing and the listener
  Result<void> failure;
  RunOnWorkers(jobs, static_cast<int>(pending.size()), [&](int job, int number) {
    {
      const std::lock_guard lock(mutex);
      if (stop.stop_requested() || !failure) return;
    }
    const StorePiece store = play(job, pending[static_cast<std::size_t>(number)]);
    const std::lock_guard lock(mutex);
    if (!store || !failure) return;
    const Result<bool> failed = store();
    if (!failed) {
      failure = tl::unexpected(failed.error());
      return;
    }
    ++progress.ran;
    ++progress.done;
    if (*failed) ++progress.failed;
    if (listener) listener(progress);
  });
  return failure;
}

PieceListener ShowOn(ProgressLine& line, const std::string& pieces, ProgressPace pace) {
  const auto start = std::chrono::steady_clock::now();
  return [&line, pieces, pace, start](const PieceProgress& now) {
    const double spent =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double left =
        spent / static_cast<double>(now.ran) * static_cast<double>(now.of - now.done);
    const std::string failed = now.failed > 0 ? fmt::format(", {} failed", now.failed) : "";
    const std::string text =
        fmt::format("{} of {} {}{}, {} left", now.done, now.of, pieces, failed, DurationText(left));
    pace == ProgressPace::kEachPiece ? line.Show(text) : line.ShowNowAndThen(text);
  };
}

}  // namespace conav::study
