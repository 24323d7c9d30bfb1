#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "common/plot/map_panel.h"
#include "launcher/run_log.h"

namespace conav::launcher {
namespace {

constexpr double kCellPixels = 24.0;  // and of the signs in a raster, whose cells are smaller
constexpr int kMostLargeCells = 60;   // a larger map is drawn as a raster
constexpr double kRasterPixels = 720.0;
constexpr double kMargin = 24.0;
constexpr double kHeaderPixels = 56.0;
constexpr double kTitlePixels = 26.0;
constexpr double kLegendPixels = 54.0;

// Okabe and Ito's palette without yellow, which is too faint on white.
constexpr std::array<const char*, 6> kRobotColours{"#0072B2", "#D55E00", "#009E73",
                                                   "#CC79A7", "#56B4E9", "#E69F00"};
constexpr std::array<const char*, 4> kDashes{"none", "7 4", "2 4", "10 3 2 3"};
constexpr CellStyles kCells;
constexpr const char* kFalseWall = "stroke=\"#D55E00\" stroke-width=\"3\"";
constexpr const char* kMissingWall = "stroke=\"#0072B2\" stroke-width=\"3\" fill=\"none\"";

constexpr const char* kFalseWallCell = "fill=\"#D55E00\"";
constexpr const char* kMissingWallCell = "fill=\"#0072B2\"";

constexpr const char* kStar = "fill=\"#F0E442\" stroke=\"#000000\" stroke-width=\"1\"";
constexpr ArrowShape kSnapshot{.length = 0.62, .half_width = 0.20};

std::string RobotStyle(std::size_t index) {
  return fmt::format(
      "stroke=\"{}\" stroke-width=\"2.5\" stroke-linejoin=\"round\" "
      "stroke-dasharray=\"{}\"",
      kRobotColours[index % kRobotColours.size()],
      kDashes[(index / kRobotColours.size() + index) % kDashes.size()]);
}

std::string Fill(std::size_t index, const char* stroke) {
  return fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1\"",
                     kRobotColours[index % kRobotColours.size()], stroke);
}
std::string RobotFill(std::size_t index) { return Fill(index, "#ffffff"); }
std::string GoalStyle(std::size_t index) { return Fill(index, "#000000"); }

double CellPixels(int rows, int columns) {
  const int cells = std::max(rows, columns);
  return cells <= kMostLargeCells ? kCellPixels : kRasterPixels / cells;
}

// Draws robots that share a corridor next to each other.
double Offset(std::size_t index) {
  constexpr std::array<double, 5> kOffsets{0.0, 4.0, -4.0, 8.0, -8.0};
  return kOffsets[index % kOffsets.size()];
}

// A cross marks a false wall, a ring a missing one.
void DrawMistake(const MapPanel& panel, PixelPosition middle, bool drawn_as_wall) {
  constexpr double kReach = 0.28;
  if (drawn_as_wall) {
    panel.DrawCross(middle, kReach, kFalseWall);
  } else {
    panel.DrawRing(middle, kReach, kMissingWall);
  }
}

void DrawMistakes(const MapPanel& panel, const OccupancyGrid& map, const OccupancyGrid& truth) {
  if (map.rows() != truth.rows() || map.columns() != truth.columns()) return;
  if (CellPixels(map.rows(), map.columns()) < MapPanel::kRasterPixels) {
    panel.DrawCells(map.rows(), map.columns(), [&](Cell cell) -> std::string_view {
      if (map[cell] == truth[cell]) return "";
      return map[cell] == Occupancy::kOccupied ? kFalseWallCell : kMissingWallCell;
    });
    return;
  }
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] == truth.values()[i]) continue;
    DrawMistake(panel, panel.Middle(map.CellAt(i)), map.values()[i] == Occupancy::kOccupied);
  }
}

void DrawRobot(SvgCanvas& canvas, const MapPanel& panel, const RobotRecord& robot,
               std::size_t index) {
  const double offset = Offset(index);
  const auto place = [&](Cell cell) {
    const PixelPosition middle = panel.Middle(cell);
    return PixelPosition{middle.x + offset, middle.y + offset};
  };
  const std::vector<Cell> trajectory = WholeTrajectory(robot);
  if (trajectory.empty()) return;
  panel.DrawPath(trajectory, RobotStyle(index), offset);
  const MapPanel signs(canvas, {}, kCellPixels);
  for (const SentSnapshot& snapshot : robot.snapshots) {
    if (!snapshot.streamed) {
      signs.DrawArrow(place(snapshot.cell), snapshot.heading_rad, kSnapshot, RobotFill(index));
    }
  }
  const PixelPosition start = place(trajectory.front());
  signs.DrawRing(start, 0.36, RobotFill(index));
  canvas.Text({start.x, start.y + 4}, robot.name,
              "font-size=\"10\" text-anchor=\"middle\" fill=\"#ffffff\" font-weight=\"bold\"");
}

/// Goals differ in colour if robots of one world have different ones.
bool HasOwnGoals(const Episode& episode, const RobotRecord& robot) {
  return std::ranges::any_of(episode.robots, [&](const RobotRecord& other) {
    return other.world == robot.world && other.goals != robot.goals;
  });
}

void DrawGoals(SvgCanvas& canvas, const MapPanel& panel, const Episode& episode,
               std::size_t index) {
  const RobotRecord& robot = episode.robots[index];
  const std::string style = HasOwnGoals(episode, robot) ? GoalStyle(index) : kStar;
  const MapPanel signs(canvas, {}, kCellPixels);
  for (const Cell goal : robot.goals) signs.DrawStar(panel.Middle(goal), style);
}

/// In the corner of the cell that paths leave free.
void NameGoals(SvgCanvas& canvas, const MapPanel& panel, const RobotRecord& robot) {
  for (const Cell goal : robot.goals) {
    const PixelPosition middle = panel.Middle(goal);
    canvas.Text({middle.x + 11, middle.y - 4}, robot.name,
                "font-size=\"9\" text-anchor=\"end\" font-weight=\"bold\" fill=\"#000000\" "
                "stroke=\"#ffffff\" stroke-width=\"2.5\" paint-order=\"stroke\"");
  }
}

void DrawEpisodeOnTruth(SvgCanvas& canvas, const MapPanel& panel, const Episode& episode,
                        const WorldRecord& world) {
  for (std::size_t i = 0; i < episode.robots.size(); ++i) {
    if (episode.robots[i].world == world.name) DrawGoals(canvas, panel, episode, i);
  }
  for (std::size_t i = 0; i < episode.robots.size(); ++i) {
    if (episode.robots[i].world == world.name) DrawRobot(canvas, panel, episode.robots[i], i);
  }
  for (const RobotRecord& robot : episode.robots) {
    if (robot.world == world.name && HasOwnGoals(episode, robot)) {
      NameGoals(canvas, panel, robot);
    }
  }
}

void DrawWorld(SvgCanvas& canvas, const Episode& episode, const WorldRecord& world, double top,
               double panel_width) {
  if (!world.truth) return;
  const std::string heading = "font-size=\"15\" fill=\"#000000\"";
  const auto panel = [&](int index, std::string_view title) {
    const PixelPosition corner{kMargin + index * (panel_width + kMargin), top + kTitlePixels};
    canvas.Text({corner.x, corner.y - 9}, fmt::format("{}: {}", world.name, title), heading);
    return MapPanel(canvas, corner, CellPixels(world.truth->rows(), world.truth->columns()));
  };
  const MapPanel truth = panel(0, "truth, trajectories, pictures");
  truth.DrawMap(*world.truth);
  DrawEpisodeOnTruth(canvas, truth, episode, world);
  if (!world.initial_map) return;
  const MapPanel before = panel(1, "operator's map before");
  before.DrawMap(*world.initial_map);
  DrawMistakes(before, *world.initial_map, *world.truth);
  const OccupancyGrid now =
      world.belief ? BeliefAsMap(world.belief->wall_probability) : *world.initial_map;
  const MapPanel after = panel(2, fmt::format("operator's map after {} edits", world.edits()));
  after.DrawMap(now);
  DrawMistakes(after, now, *world.truth);
}

void DrawLegend(SvgCanvas& canvas, double top, bool own_goals) {
  const char* text = "font-size=\"13\" fill=\"#000000\"";
  const MapPanel signs(canvas, {}, kCellPixels);
  const double y = top + 20;
  double x = kMargin;
  const auto next = [&](std::string_view label, double advance) {
    canvas.Text({x + 20, y + 5}, label, text);
    x += advance;
  };
  canvas.Rectangle({x, y - 8}, 16, 16, kCells.wall);
  next("wall", 70);
  canvas.Circle({x + 8, y}, 8, RobotFill(0));
  next("start of a robot", 140);
  canvas.Line({x - 4, y}, {x + 16, y}, RobotStyle(0));
  next("its path", 90);
  signs.DrawArrow({x, y}, 0.0, kSnapshot, RobotFill(0));
  next("picture sent, in this direction", 225);
  signs.DrawStar({x + 8, y}, own_goals ? GoalStyle(0) : kStar);
  next(own_goals ? "its goal" : "goal", 80);
  DrawMistake(signs, {x + 8, y}, true);
  next("false wall on the map", 205);
  DrawMistake(signs, {x + 8, y}, false);
  next("missing wall", 100);
}

}  // namespace

std::string EpisodeSvg(const Episode& episode, std::string_view title) {
  int rows = 1;
  int columns = 1;
  for (const WorldRecord& world : episode.worlds) {
    if (!world.truth) continue;
    rows = std::max(rows, world.truth->rows());
    columns = std::max(columns, world.truth->columns());
  }
  const double cell_pixels = CellPixels(rows, columns);
  const double panel_width = std::max(columns * cell_pixels, 290.0);
  const double world_height = kTitlePixels + rows * cell_pixels + kMargin;
  SvgCanvas canvas;
  canvas.Text({kMargin, 34}, title, "font-size=\"20\" fill=\"#000000\"");
  double top = kHeaderPixels;
  for (const WorldRecord& world : episode.worlds) {
    DrawWorld(canvas, episode, world, top, panel_width);
    top += world_height;
  }
  DrawLegend(canvas, top, std::ranges::any_of(episode.robots, [&](const RobotRecord& robot) {
               return HasOwnGoals(episode, robot);
             }));
  return canvas.Document(kMargin + 3 * (panel_width + kMargin), top + kLegendPixels, title);
}

}  // namespace conav::launcher
