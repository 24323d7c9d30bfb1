#pragma once

#include <cstddef>
#include <cstdio>
#include <map>
#include <string>

#include "common/runtime/clock.h"
#include "launcher/run_log.h"

namespace conav::launcher {

/// "r1 w1  cell (3,5)  goals 2/4  moves 31  pictures 6  decisions 40, median 12 ms" or "r1
/// waiting".
std::string ProgressLine(const RobotRecord& robot);

/// Shows a run in progress. On a terminal: one line per robot, rewritten in place. Elsewhere: plain
/// lines, one when a robot reaches a goal, and one per robot every few seconds. kSilent writes
/// nothing.
class Progress {
 public:
  enum class Style { kTerminal, kPlain, kSilent };
  Progress(std::FILE* output, Style style, const Clock& clock);

  /// Call at any rate; it only writes news.
  void Show(const Episode& episode);
  /// Prints a line above the robots' lines.
  void Say(const std::string& line);
  /// Leaves the newest lines on the screen.
  void Finish(const Episode& episode);

 private:
  void Rewrite(const Episode& episode);
  void ShowPlain(const Episode& episode);

  std::FILE* output_;
  Style style_;
  const Clock& clock_;
  Clock::TimePoint next_{};
  std::size_t lines_on_screen_ = 0;
  std::map<std::string, std::size_t> goals_shown_;
};

/// The result of a run, one line per robot and a line for the maps. Everything left of the "median"
/// column is the same for the same seed (one robot); the two time columns are wall times.
std::string ResultTable(const EpisodeMetrics& metrics);

/// "12.3 kB", "1.0 MB".
std::string ShortBytes(std::uint64_t bytes);

}  // namespace conav::launcher
