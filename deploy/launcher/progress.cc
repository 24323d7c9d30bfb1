#include "launcher/progress.h"

#include <fmt/format.h>

#include "launcher/metrics.h"

namespace conav::launcher {
namespace {

constexpr std::chrono::milliseconds kTerminalPeriod{200};
constexpr std::chrono::seconds kPlainPeriod{5};

}  // namespace

std::string ProgressLine(const RobotRecord& robot) {
  if (!robot.state)
    return fmt::format("{:<4}{:<4}waiting for its first state", robot.name, robot.world);
  const RobotMetrics metrics = MeasureRobot(robot);
  std::string line = fmt::format(
      "{:<4}{:<4}cell {:<8} goals {}/{}  moves {:<4} pictures {:<3} guidance {:<3}", robot.name,
      robot.world, fmt::format("{}", robot.state->cell), metrics.goals_reached, metrics.goals_total,
      metrics.cell_moves, metrics.pictures, metrics.guidance);
  line +=
      fmt::format(" decisions {}, median {:.0f} ms", metrics.decisions, metrics.decision_ms_median);
  if (robot.perception_model.starts_with("fallback")) line += "  [" + robot.perception_model + "]";
  return line;
}

Progress::Progress(std::FILE* output, Style style, const Clock& clock)
    : output_(output), style_(style), clock_(clock) {}

void Progress::Show(const Episode& episode) {
  if (style_ == Style::kSilent) return;
  if (style_ == Style::kPlain) {
    ShowPlain(episode);
    return;
  }
  if (clock_.Now() < next_) return;
  next_ = clock_.Now() + kTerminalPeriod;
  Rewrite(episode);
}

void Progress::Rewrite(const Episode& episode) {
  if (lines_on_screen_ > 0) fmt::print(output_, "\x1b[{}A", lines_on_screen_);
  for (const RobotRecord& robot : episode.robots) {
    fmt::print(output_, "\x1b[2K{}\n", ProgressLine(robot));
  }
  lines_on_screen_ = episode.robots.size();
  std::fflush(output_);
}

void Progress::ShowPlain(const Episode& episode) {
  const bool due = clock_.Now() >= next_;
  if (due) next_ = clock_.Now() + kPlainPeriod;
  for (const RobotRecord& robot : episode.robots) {
    const std::size_t reached = robot.state ? robot.state->goals_reached.size() : 0;
    std::size_t& told = goals_told_[robot.name];
    if (due || reached > told) fmt::print(output_, "{}\n", ProgressLine(robot));
    told = reached;
  }
  std::fflush(output_);
}

void Progress::Say(const std::string& line) {
  if (style_ == Style::kSilent) return;
  // The robots' lines move up with the rest; they are written again below.
  lines_on_screen_ = 0;
  fmt::print(output_, "{}\n", line);
  std::fflush(output_);
}

void Progress::Finish(const Episode& episode) {
  if (style_ == Style::kTerminal) Rewrite(episode);
}

}  // namespace conav::launcher
