#include "launcher/table.h"

#include <fmt/format.h>

namespace conav::launcher {

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
        robot.low_level_steps, robot.pictures, ShortBytes(robot.picture_bytes), robot.guidance,
        robot.decisions, robot.decision_ms_median, robot.decision_ms_p99);
  }
  text += fmt::format(
      "mapping accuracy {:.0f} % -> {:.0f} %   cells right {:.1f} % -> {:.1f} %   all goals "
      "reached: {}\n",
      100 * metrics.before.mapping, 100 * metrics.after.mapping, 100 * metrics.before.cell,
      100 * metrics.after.cell, metrics.all_goals_reached ? "yes" : "no");
  return text;
}

}  // namespace conav::launcher
