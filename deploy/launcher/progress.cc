#include "launcher/progress.h"

#include <fmt/core.h>

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
      metrics.cell_moves, metrics.images, metrics.guidance);
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
    std::size_t& shown = goals_shown_[robot.name];
    if (due || reached > shown) fmt::print(output_, "{}\n", ProgressLine(robot));
    shown = reached;
  }
  std::fflush(output_);
}

void Progress::Say(const std::string& line) {
  if (style_ == Style::kSilent) return;
  // The robots' lines scroll up with the rest; Show() writes them again below.
  lines_on_screen_ = 0;
  fmt::print(output_, "{}\n", line);
  std::fflush(output_);
}

void Progress::Finish(const Episode& episode) {
  if (style_ == Style::kTerminal) Rewrite(episode);
}

std::string ShortBytes(std::uint64_t bytes) {
  if (bytes < 1000) return fmt::format("{} B", bytes);
  const double value = static_cast<double>(bytes);
  if (bytes < 1000 * 1000) return fmt::format("{:.1f} kB", value / 1e3);
  return fmt::format("{:.1f} MB", value / 1e6);
}

std::string ResultTable(const EpisodeMetrics& metrics) {
  std::string text = fmt::format("{:<6}{:<6}{:>8}{:>8}{:>8}{:>10}{:>11}{:>10}{:>11}{:>12}{:>10}\n",
                                 "robot", "world", "goals", "moves", "steps", "pictures", "sent",
                                 "guidance", "decisions", "median ms", "p99 ms");
  for (const RobotMetrics& robot : metrics.robots) {
    text += fmt::format(
        "{:<6}{:<6}{:>8}{:>8}{:>8}{:>10}{:>11}{:>10}{:>11}{:>12.1f}{:>10.1f}\n", robot.name,
        robot.world, fmt::format("{}/{}", robot.goals_reached, robot.goals_total), robot.cell_moves,
        robot.low_level_steps, robot.images, ShortBytes(robot.image_bytes), robot.guidance,
        robot.decisions, robot.decision_ms_median, robot.decision_ms_p99);
  }
  const double optimum = metrics.path_over_optimum();
  text += fmt::format(
      "mapping accuracy {:.0f} % -> {:.0f} %   cells right {:.1f} % -> {:.1f} %   all goals "
      "reached: {}{}\n",
      100 * metrics.before.mapping, 100 * metrics.after.mapping, 100 * metrics.before.cell,
      100 * metrics.after.cell, metrics.all_goals_reached ? "yes" : "no",
      optimum > 0.0 ? fmt::format("   path over optimum {:.2f}", optimum) : "");
  for (const auto& [name, client] : metrics.clients) {
    text += fmt::format("{} ({}): {} edits of {} cells, {} paths, {} answers, {} other commands\n",
                        name, client.at_page ? "at the console" : "program", client.edits,
                        client.cells, client.paths, client.answers, client.other);
  }
  for (const RobotMetrics& robot : metrics.robots) {
    if (robot.camera_bytes == 0) continue;
    text +=
        fmt::format("{}: live view on request, {}\n", robot.name, ShortBytes(robot.camera_bytes));
  }
  return text;
}

}  // namespace conav::launcher
