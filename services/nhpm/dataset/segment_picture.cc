#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "common/plot/map_panel.h"
#include "nhpm/dataset/set_summary.h"

namespace conav::nhpm {
namespace {

constexpr double kCellPixels = 18.0;
constexpr double kMargin = 24.0;
constexpr double kTitlePixels = 52.0;
constexpr double kLabelPixels = 26.0;
constexpr double kLegendPixels = 44.0;

// Okabe and Ito's palette, which people with every common colour blindness can tell apart; each
// kind of edit also has its own sign.
constexpr const char* kWall = "fill=\"#4a4a4a\"";
constexpr const char* kFree = "fill=\"#f4f4f4\"";
constexpr const char* kUnseen = "fill=\"#d8d8d8\"";
constexpr const char* kPath =
    "stroke=\"#0072B2\" stroke-width=\"3\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";
constexpr const char* kCamera = "fill=\"#0072B2\" stroke=\"#ffffff\" stroke-width=\"1\"";
constexpr const char* kAdded = "stroke=\"#D55E00\" stroke-width=\"3\"";
constexpr const char* kRemoved = "stroke=\"#009E73\" stroke-width=\"3\" fill=\"none\"";
constexpr const char* kText = "font-size=\"13\" fill=\"#000000\"";

constexpr CellStyles kCells{.wall = kWall, .free = kFree, .unknown = kUnseen};
constexpr ArrowShape kCameraShape{.length = 0.75, .half_width = 0.3};

void DrawCamera(const MapPanel& panel, const PerceptionQuery& query) {
  panel.DrawArrow(panel.Middle(query.cell), query.heading_rad, kCameraShape, kCamera);
}

void DrawBefore(const MapPanel& panel, const PerceptionQuery& query) {
  panel.DrawMap(query.belief, kCells);
  panel.DrawPath(query.path, kPath);
  DrawCamera(panel, query);
}

void DrawShown(const MapPanel& panel, const PerceptionQuery& query) {
  for (std::size_t i = 0; i < query.belief.size(); ++i) {
    panel.DrawCell(query.belief.CellAt(i), kUnseen);
  }
  for (const Cell cell : query.visible.free) panel.DrawCell(cell, kFree);
  for (const Cell cell : query.visible.walls) panel.DrawCell(cell, kWall);
  DrawCamera(panel, query);
}

/// A cross marks an added wall, a ring a removed one.
void DrawEdit(const MapPanel& panel, PixelPosition middle, bool added) {
  constexpr double kReach = 0.3;
  if (added) {
    panel.DrawCross(middle, kReach, kAdded);
  } else {
    panel.DrawRing(middle, kReach, kRemoved);
  }
}

void DrawAfter(const MapPanel& panel, const Segment& segment) {
  panel.DrawMap(segment.belief_after, kCells);
  const EditLabels labels = LabelsOf(segment);
  for (std::size_t i = 0; i < labels.add.size(); ++i) {
    const bool added = labels.add.values()[i] != 0;
    if (!added && labels.remove.values()[i] == 0) continue;
    DrawEdit(panel, panel.Middle(labels.add.CellAt(i)), added);
  }
}

void DrawSegment(SvgCanvas& canvas, const ChosenSegment& chosen, double top, double panel_width) {
  const Segment& segment = *chosen.segment;
  const auto panel = [&](int index) {
    return MapPanel(canvas, {kMargin + index * (panel_width + kMargin), top + kLabelPixels},
                    kCellPixels);
  };
  canvas.Text(
      {kMargin, top + 16},
      fmt::format("segment {}, trajectory {}, step {}, {}: {} edits", chosen.index,
                  chosen.trajectory, segment.step, ToText(chosen.origin), EditCount(segment)),
      kText);
  DrawBefore(panel(0), segment.query);
  DrawShown(panel(1), segment.query);
  DrawAfter(panel(2), segment);
}

void DrawLegend(SvgCanvas& canvas, double top) {
  const MapPanel signs(canvas, {}, kCellPixels);
  const double y = top + 16;
  double x = kMargin;
  const auto next = [&](std::string_view label, double advance) {
    canvas.Text({x + 20, y + 5}, label, kText);
    x += advance;
  };
  canvas.Rectangle({x, y - 8}, 16, 16, kWall);
  next("wall", 64);
  canvas.Rectangle({x, y - 8}, 16, 16, kUnseen);
  next("not shown", 100);
  canvas.Polyline({{x - 2, y}, {x + 16, y}}, kPath);
  next("path", 64);
  signs.DrawArrow({x + 2, y}, 0.0, kCameraShape, kCamera);
  next("camera", 82);
  DrawEdit(signs, {x + 8, y}, true);
  next("wall added", 104);
  DrawEdit(signs, {x + 8, y}, false);
  next("wall removed", 110);
}

using CharacterGrid = Grid<char>;

CharacterGrid Drawn(const BeliefGrid& map) {
  CharacterGrid drawn(map.rows(), map.columns(), ' ');
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] != 0.0F) drawn.values()[i] = '#';
  }
  return drawn;
}

char CameraSign(double heading_rad) {
  constexpr std::string_view kSigns = ">^<v";
  const auto quarter = std::lround(heading_rad / (std::numbers::pi / 2.0)) % 4;
  return kSigns[static_cast<std::size_t>((quarter + 4) % 4)];
}

CharacterGrid Before(const PerceptionQuery& query) {
  CharacterGrid drawn = Drawn(query.belief);
  for (const Cell cell : query.path) drawn[cell] = 'o';
  drawn[query.cell] = CameraSign(query.heading_rad);
  return drawn;
}

CharacterGrid Shown(const PerceptionQuery& query) {
  CharacterGrid drawn(query.belief.rows(), query.belief.columns(), ' ');
  for (const Cell cell : query.visible.free) drawn[cell] = '.';
  for (const Cell cell : query.visible.walls) drawn[cell] = '#';
  return drawn;
}

CharacterGrid After(const Segment& segment) {
  CharacterGrid drawn = Drawn(segment.belief_after);
  const EditLabels labels = LabelsOf(segment);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (labels.add.values()[i] != 0) drawn.values()[i] = '+';
    if (labels.remove.values()[i] != 0) drawn.values()[i] = '-';
  }
  return drawn;
}

std::string RowOf(const CharacterGrid& grid, int row) {
  const auto columns = static_cast<std::size_t>(grid.columns());
  return {grid.values().data() + static_cast<std::size_t>(row) * columns, columns};
}

std::vector<ChosenSegment> All(const SegmentSet& set) {
  std::vector<ChosenSegment> all;
  for (std::size_t t = 0; t < set.trajectories.size(); ++t) {
    for (const Segment& segment : set.trajectories[t].segments) {
      all.push_back({all.size(), t, &segment, set.trajectories[t].origin});
    }
  }
  return all;
}

/// Up to `count` of `all`, evenly spread.
std::vector<ChosenSegment> SpreadOver(const std::vector<ChosenSegment>& all, std::size_t count) {
  std::vector<ChosenSegment> chosen;
  const std::size_t taken = std::min(count, all.size());
  for (std::size_t i = 0; i < taken; ++i) chosen.push_back(all[i * all.size() / taken]);
  return chosen;
}

}  // namespace

std::string SegmentsSvg(std::span<const ChosenSegment> chosen, std::string_view title) {
  double panel_width = 170.0;  // room for the legend under three
  double top = kTitlePixels;
  for (const ChosenSegment& one : chosen) {
    panel_width = std::max(panel_width, one.segment->query.belief.columns() * kCellPixels);
  }
  SvgCanvas canvas;
  canvas.Text({kMargin, 30}, title, "font-size=\"18\" fill=\"#000000\"");
  canvas.Text({kMargin, 48},
              "map before and path | what the picture shows | map after, edits marked", kText);
  for (const ChosenSegment& one : chosen) {
    DrawSegment(canvas, one, top, panel_width);
    top += kLabelPixels + one.segment->query.belief.rows() * kCellPixels + kMargin / 2;
  }
  DrawLegend(canvas, top);
  return canvas.Document(kMargin + 3 * (panel_width + kMargin), top + kLegendPixels, title);
}

std::string SegmentText(const ChosenSegment& chosen) {
  const Segment& segment = *chosen.segment;
  std::string text =
      fmt::format("segment {} (trajectory {}, step {}, {}): {} edits\n", chosen.index,
                  chosen.trajectory, segment.step, ToText(chosen.origin), EditCount(segment));
  const CharacterGrid panels[] = {Before(segment.query), Shown(segment.query), After(segment)};
  const auto width = static_cast<std::size_t>(std::max(panels[0].columns(), 6));
  text += fmt::format("  {:<{}}  {:<{}}  after\n", "before", width, "shown", width);
  for (int row = 0; row < panels[0].rows(); ++row) {
    text += fmt::format("  {:<{}}  {:<{}}  {}\n", RowOf(panels[0], row), width,
                        RowOf(panels[1], row), width, RowOf(panels[2], row));
  }
  return text;
}

Result<std::vector<ChosenSegment>> ChooseSegments(const SegmentSet& set,
                                                  std::span<const std::size_t> indices) {
  const std::vector<ChosenSegment> all = All(set);
  std::vector<ChosenSegment> chosen;
  for (const std::size_t index : indices) {
    if (index >= all.size()) {
      return Fail(
          ErrorCode::kOutOfRange,
          fmt::format("there is no segment {}; the set has {}, from 0 on", index, all.size()));
    }
    chosen.push_back(all[index]);
  }
  return chosen;
}

std::vector<ChosenSegment> ChooseSegments(const SegmentSet& set, std::size_t count) {
  std::vector<ChosenSegment> edited = All(set);
  const auto others =
      std::stable_partition(edited.begin(), edited.end(),
                            [](const ChosenSegment& one) { return EditCount(*one.segment) > 0; });
  const std::vector<ChosenSegment> unedited(others, edited.end());
  edited.erase(others, edited.end());
  std::vector<ChosenSegment> chosen = SpreadOver(edited, count);
  for (const ChosenSegment& one : SpreadOver(unedited, count - chosen.size()))
    chosen.push_back(one);
  std::sort(chosen.begin(), chosen.end(),
            [](const ChosenSegment& a, const ChosenSegment& b) { return a.index < b.index; });
  return chosen;
}

}  // namespace conav::nhpm
