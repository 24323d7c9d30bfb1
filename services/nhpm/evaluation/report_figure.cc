#include "nhpm/evaluation/report_figure.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "common/segments/segment_labels.h"
#include "common/svg/svg_canvas.h"

namespace conav::nhpm {
namespace {

constexpr double kCell = 18.0;
constexpr double kLowestShown = 0.05;

PixelPosition Corner(Cell cell) { return {cell.column * kCell, cell.row * kCell}; }
PixelPosition Middle(Cell cell) { return {(cell.column + 0.5) * kCell, (cell.row + 0.5) * kCell}; }

void DrawCell(SvgCanvas& canvas, Cell cell, const std::string& style) {
  canvas.Rectangle(Corner(cell), kCell - 1, kCell - 1, style);
}

void DrawMap(SvgCanvas& canvas, const BeliefGrid& map, const char* wall_class = "wall") {
  for (std::size_t i = 0; i < map.size(); ++i) {
    DrawCell(canvas, map.CellAt(i),
             fmt::format("class=\"{}\"", map.values()[i] >= 0.5F ? wall_class : "free"));
  }
}

void DrawCamera(SvgCanvas& canvas, const PerceptionQuery& query) {
  const PixelPosition from = Middle(query.cell);
  const double x = std::cos(query.heading_rad);
  const double y = -std::sin(query.heading_rad);  // pixels run down, the map's y runs up
  constexpr double kLength = kCell * 0.75;
  constexpr double kHalfWidth = kCell * 0.28;
  canvas.Polygon({{from.x + x * kLength, from.y + y * kLength},
                  {from.x - y * kHalfWidth, from.y + x * kHalfWidth},
                  {from.x + y * kHalfWidth, from.y - x * kHalfWidth}},
                 "class=\"camera\"");
}

std::string Panel(const SvgCanvas& canvas, const Segment& segment, const std::string& title) {
  const BeliefGrid& map = segment.query.belief;
  return canvas.Inline(map.columns() * kCell, map.rows() * kCell, title);
}

void DrawProbability(SvgCanvas& canvas, Cell cell, double probability, const char* kind) {
  if (probability < kLowestShown) return;
  canvas.BeginGroup(fmt::format("{} at {}: {:.3f}", kind, cell, probability));
  DrawCell(canvas, cell, fmt::format("class=\"{}\" fill-opacity=\"{:.3f}\"", kind, probability));
  const PixelPosition middle = Middle(cell);
  canvas.Text({middle.x, middle.y + 3.5}, fmt::format("{:.0f}", 100.0 * probability),
              "class=\"percent\" text-anchor=\"middle\"");
  canvas.EndGroup();
}

void DrawEdit(SvgCanvas& canvas, Cell cell, const char* kind, const char* sign) {
  canvas.BeginGroup(fmt::format("{} at {}", kind, cell));
  DrawCell(canvas, cell, fmt::format("class=\"{}\"", kind));
  const PixelPosition middle = Middle(cell);
  canvas.Text({middle.x, middle.y + 5.5}, sign, "class=\"sign\" text-anchor=\"middle\"");
  canvas.EndGroup();
}

}  // namespace

std::string MapPanel(const Segment& segment) {
  SvgCanvas canvas;
  DrawMap(canvas, segment.query.belief);
  return Panel(canvas, segment, "The operator's map before the picture");
}

std::string ViewPanel(const Segment& segment) {
  const PerceptionQuery& query = segment.query;
  SvgCanvas canvas;
  DrawMap(canvas, BeliefGrid(query.belief.rows(), query.belief.columns(), 0.0F));
  for (const Cell cell : query.visible.free) DrawCell(canvas, cell, "class=\"seen-free\"");
  for (const Cell cell : query.visible.walls) DrawCell(canvas, cell, "class=\"seen-wall\"");
  std::vector<PixelPosition> path;
  for (const Cell cell : query.path) path.push_back(Middle(cell));
  canvas.Polyline(path, "class=\"path\"");
  DrawCamera(canvas, query);
  return Panel(canvas, segment,
               fmt::format("Path of {} cells; the picture from {} shows {} free cells and {} walls",
                           query.path.size(), query.cell, query.visible.free.size(),
                           query.visible.walls.size()));
}

std::string PredictionPanel(const Segment& segment, const PerceptionAnswer& answer,
                            const std::string& title) {
  SvgCanvas canvas;
  DrawMap(canvas, segment.query.belief, "faint-wall");
  for (std::size_t i = 0; i < answer.add.size(); ++i) {
    const Cell cell = answer.add.CellAt(i);
    DrawProbability(canvas, cell, static_cast<double>(answer.add.values()[i]), "add");
    DrawProbability(canvas, cell, static_cast<double>(answer.remove.values()[i]), "remove");
  }
  DrawCamera(canvas, segment.query);
  return Panel(canvas, segment,
               fmt::format("{}: {:.2f} edits expected", title, ExpectedEdits(answer)));
}

std::string TruthPanel(const Segment& segment) {
  SvgCanvas canvas;
  DrawMap(canvas, segment.query.belief, "faint-wall");
  const EditLabels labels = LabelsOf(segment);
  for (std::size_t i = 0; i < labels.add.size(); ++i) {
    const Cell cell = labels.add.CellAt(i);
    if (labels.add.values()[i] != 0) DrawEdit(canvas, cell, "add", "+");
    if (labels.remove.values()[i] != 0) DrawEdit(canvas, cell, "remove", "\u2212");
  }
  DrawCamera(canvas, segment.query);
  return Panel(canvas, segment, fmt::format("What was done: {} edits", EditCount(segment)));
}

}  // namespace conav::nhpm
