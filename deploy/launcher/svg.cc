#include "launcher/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/svg/svg_canvas.h"

namespace conav::launcher {
namespace {

constexpr double kCellPixels = 24.0;
constexpr double kMargin = 24.0;
constexpr double kHeaderPixels = 56.0;
constexpr double kTitlePixels = 26.0;
constexpr double kLegendPixels = 54.0;

// Okabe and Ito's palette without yellow, which is too faint on white.
constexpr std::array<const char*, 6> kRobotColours{"#0072B2", "#D55E00", "#009E73",
                                                   "#CC79A7", "#56B4E9", "#E69F00"};
constexpr std::array<const char*, 4> kDashes{"none", "7 4", "2 4", "10 3 2 3"};
constexpr const char* kWall = "fill=\"#4a4a4a\"";
constexpr const char* kFree = "fill=\"#f4f4f4\"";
constexpr const char* kUnknown = "fill=\"#c8c8c8\"";
constexpr const char* kFalseWall = "stroke=\"#D55E00\" stroke-width=\"3\"";
constexpr const char* kMissingWall = "stroke=\"#0072B2\" stroke-width=\"3\" fill=\"none\"";

/// Where a grid lies on the canvas.
struct Panel {
  PixelPosition corner;
  PixelPosition Middle(Cell cell) const {
    return {corner.x + (cell.column + 0.5) * kCellPixels,
            corner.y + (cell.row + 0.5) * kCellPixels};
  }
  PixelPosition Corner(Cell cell) const {
    return {corner.x + cell.column * kCellPixels, corner.y + cell.row * kCellPixels};
  }
};

std::string RobotStyle(std::size_t index) {
  return fmt::format(
      "stroke=\"{}\" stroke-width=\"2.5\" stroke-linejoin=\"round\" "
      "stroke-dasharray=\"{}\"",
      kRobotColours[index % kRobotColours.size()],
      kDashes[(index / kRobotColours.size() + index) % kDashes.size()]);
}

std::string RobotFill(std::size_t index) {
  return fmt::format("fill=\"{}\" stroke=\"#ffffff\" stroke-width=\"1\"",
                     kRobotColours[index % kRobotColours.size()]);
}

// Robots that share a corridor are drawn beside each other.
double Offset(std::size_t index) {
  constexpr std::array<double, 5> kOffsets{0.0, 4.0, -4.0, 8.0, -8.0};
  return kOffsets[index % kOffsets.size()];
}

void DrawGrid(SvgCanvas& canvas, const Panel& panel, const OccupancyGrid& map) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Occupancy occupancy = map.values()[i];
    const char* style = occupancy == Occupancy::kOccupied ? kWall
                        : occupancy == Occupancy::kFree   ? kFree
                                                          : kUnknown;
    canvas.Rectangle(panel.Corner(map.CellAt(i)), kCellPixels - 1, kCellPixels - 1, style);
  }
}

// A cross: a wall that is not there. A ring: a wall that is missing.
void DrawMistake(SvgCanvas& canvas, PixelPosition middle, bool drawn_as_wall) {
  constexpr double kReach = kCellPixels * 0.28;
  if (drawn_as_wall) {
    canvas.Cross(middle, kReach, kFalseWall);
  } else {
    canvas.Circle(middle, kReach, kMissingWall);
  }
}

void DrawMistakes(SvgCanvas& canvas, const Panel& panel, const OccupancyGrid& map,
                  const OccupancyGrid& truth) {
  if (map.rows() != truth.rows() || map.columns() != truth.columns()) return;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] == truth.values()[i]) continue;
    DrawMistake(canvas, panel.Middle(map.CellAt(i)), map.values()[i] == Occupancy::kOccupied);
  }
}

void DrawArrow(SvgCanvas& canvas, PixelPosition from, double heading_rad, const std::string& fill) {
  const double x = std::cos(heading_rad);
  const double y = -std::sin(heading_rad);  // pixels run down, the map's y runs up
  constexpr double kLength = kCellPixels * 0.62;
  constexpr double kHalfWidth = kCellPixels * 0.20;
  const PixelPosition tip{from.x + x * kLength, from.y + y * kLength};
  canvas.Polygon({tip,
                  {from.x - y * kHalfWidth, from.y + x * kHalfWidth},
                  {from.x + y * kHalfWidth, from.y - x * kHalfWidth}},
                 fill);
}

void DrawStar(SvgCanvas& canvas, PixelPosition middle) {
  std::vector<PixelPosition> corners;
  for (int i = 0; i < 10; ++i) {
    const double radius = kCellPixels * (i % 2 == 0 ? 0.42 : 0.18);
    const double angle = (i * 36.0 - 90.0) * 3.14159265358979 / 180.0;
    corners.push_back({middle.x + radius * std::cos(angle), middle.y + radius * std::sin(angle)});
  }
  canvas.Polygon(corners, "fill=\"#F0E442\" stroke=\"#000000\" stroke-width=\"1\"");
}

void DrawRobot(SvgCanvas& canvas, const Panel& panel, const RobotRecord& robot, std::size_t index) {
  const double offset = Offset(index);
  const auto place = [&](Cell cell) {
    const PixelPosition middle = panel.Middle(cell);
    return PixelPosition{middle.x + offset, middle.y + offset};
  };
  const std::vector<Cell> trajectory = WholeTrajectory(robot);
  if (trajectory.empty()) return;
  std::vector<PixelPosition> line;
  for (const Cell cell : trajectory) line.push_back(place(cell));
  canvas.Polyline(line, RobotStyle(index));
  for (const SentPicture& picture : robot.pictures) {
    if (!picture.streamed) {
      DrawArrow(canvas, place(picture.cell), picture.heading_rad, RobotFill(index));
    }
  }
  const PixelPosition start = place(trajectory.front());
  canvas.Circle(start, kCellPixels * 0.36, RobotFill(index));
  canvas.Text({start.x, start.y + 4}, robot.name,
              "font-size=\"10\" text-anchor=\"middle\" fill=\"#ffffff\" font-weight=\"bold\"");
}

void DrawEpisodeOnTruth(SvgCanvas& canvas, const Panel& panel, const Episode& episode,
                        const WorldRecord& world) {
  for (const RobotRecord& robot : episode.robots) {
    if (robot.world != world.name) continue;
    for (const Cell goal : robot.goals) DrawStar(canvas, panel.Middle(goal));
  }
  for (std::size_t i = 0; i < episode.robots.size(); ++i) {
    if (episode.robots[i].world == world.name) DrawRobot(canvas, panel, episode.robots[i], i);
  }
}

void DrawWorld(SvgCanvas& canvas, const Episode& episode, const WorldRecord& world, double top,
               double panel_width) {
  const std::string heading = "font-size=\"15\" fill=\"#000000\"";
  const auto panel = [&](int index, std::string_view title) {
    const PixelPosition corner{kMargin + index * (panel_width + kMargin), top + kTitlePixels};
    canvas.Text({corner.x, corner.y - 9}, fmt::format("{}: {}", world.name, title), heading);
    return Panel{corner};
  };
  if (!world.truth) return;
  const Panel truth = panel(0, "truth, trajectories, pictures");
  DrawGrid(canvas, truth, *world.truth);
  DrawEpisodeOnTruth(canvas, truth, episode, world);
  if (!world.initial_map) return;
  const Panel before = panel(1, "operator's map before");
  DrawGrid(canvas, before, *world.initial_map);
  DrawMistakes(canvas, before, *world.initial_map, *world.truth);
  const OccupancyGrid now =
      world.belief ? BeliefAsMap(world.belief->wall_probability) : *world.initial_map;
  const Panel after = panel(2, fmt::format("operator's map after {} edits", world.edits()));
  DrawGrid(canvas, after, now);
  DrawMistakes(canvas, after, now, *world.truth);
}

void DrawLegend(SvgCanvas& canvas, double top) {
  const char* text = "font-size=\"13\" fill=\"#000000\"";
  const double y = top + 20;
  double x = kMargin;
  const auto next = [&](std::string_view label, double advance) {
    canvas.Text({x + 20, y + 5}, label, text);
    x += advance;
  };
  canvas.Rectangle({x, y - 8}, 16, 16, kWall);
  next("wall", 70);
  canvas.Circle({x + 8, y}, 8, RobotFill(0));
  next("start of a robot", 140);
  canvas.Line({x - 4, y}, {x + 16, y}, RobotStyle(0));
  next("its way", 90);
  DrawArrow(canvas, {x, y}, 0.0, RobotFill(0));
  next("picture sent, looking this way", 225);
  DrawStar(canvas, {x + 8, y});
  next("goal", 70);
  DrawMistake(canvas, {x + 8, y}, true);
  next("wall drawn that is not there", 205);
  DrawMistake(canvas, {x + 8, y}, false);
  next("wall missing", 100);
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
  const double panel_width = std::max(columns * kCellPixels, 290.0);
  const double world_height = kTitlePixels + rows * kCellPixels + kMargin;
  SvgCanvas canvas;
  canvas.Text({kMargin, 34}, title, "font-size=\"20\" fill=\"#000000\"");
  double top = kHeaderPixels;
  for (const WorldRecord& world : episode.worlds) {
    DrawWorld(canvas, episode, world, top, panel_width);
    top += world_height;
  }
  DrawLegend(canvas, top);
  return canvas.Document(kMargin + 3 * (panel_width + kMargin), top + kLegendPixels, title);
}

}  // namespace conav::launcher
