#include "nhpm/evaluation/report_figure.h"

#include <fmt/format.h>

#include <string_view>

#include "common/segments/segment_labels.h"
#include "common/svg/map_panel.h"

namespace conav::nhpm {
namespace {

constexpr double kCell = 18.0;
constexpr double kLowestShown = 0.05;

constexpr std::string_view kFree = "class=\"free\"";
constexpr CellStyles kCells{.wall = "class=\"wall\"", .free = kFree, .unknown = kFree};
constexpr CellStyles kFaintCells{.wall = "class=\"faint-wall\"", .free = kFree, .unknown = kFree};

/// One of the figure's panels, which fills its canvas.
struct Figure {
  explicit Figure(const Segment& figure_segment) : segment(figure_segment) {}

  std::string Inline(const std::string& title) const {
    const BeliefGrid& belief = segment.query.belief;
    return canvas.Inline(belief.columns() * kCell, belief.rows() * kCell, title);
  }
  void DrawCamera() const {
    const PerceptionQuery& query = segment.query;
    map.DrawArrow(map.Middle(query.cell), query.heading_rad, {.length = 0.75, .half_width = 0.28},
                  "class=\"camera\"");
  }

  const Segment& segment;
  SvgCanvas canvas;
  MapPanel map{canvas, {}, kCell};
};

void DrawProbability(Figure& figure, Cell cell, double probability, const char* kind) {
  if (probability < kLowestShown) return;
  figure.canvas.BeginGroup(fmt::format("{} at {}: {:.3f}", kind, cell, probability));
  figure.map.DrawCell(cell, fmt::format("class=\"{}\" fill-opacity=\"{:.3f}\"", kind, probability));
  const PixelPosition middle = figure.map.Middle(cell);
  figure.canvas.Text({middle.x, middle.y + 3.5}, fmt::format("{:.0f}", 100.0 * probability),
                     "class=\"percent\" text-anchor=\"middle\"");
  figure.canvas.EndGroup();
}

void DrawEdit(Figure& figure, Cell cell, const char* kind, const char* sign) {
  figure.canvas.BeginGroup(fmt::format("{} at {}", kind, cell));
  figure.map.DrawCell(cell, fmt::format("class=\"{}\"", kind));
  const PixelPosition middle = figure.map.Middle(cell);
  figure.canvas.Text({middle.x, middle.y + 5.5}, sign, "class=\"sign\" text-anchor=\"middle\"");
  figure.canvas.EndGroup();
}

}  // namespace

std::string BeforePanel(const Segment& segment) {
  const Figure figure(segment);
  figure.map.DrawMap(segment.query.belief, kCells);
  return figure.Inline("The operator's map before the picture");
}

std::string ViewPanel(const Segment& segment) {
  const PerceptionQuery& query = segment.query;
  const Figure figure(segment);
  figure.map.DrawMap(BeliefGrid(query.belief.rows(), query.belief.columns(), 0.0F), kCells);
  for (const Cell cell : query.visible.free) figure.map.DrawCell(cell, "class=\"seen-free\"");
  for (const Cell cell : query.visible.walls) figure.map.DrawCell(cell, "class=\"seen-wall\"");
  figure.map.DrawPath(query.path, "class=\"path\"");
  figure.DrawCamera();
  return figure.Inline(fmt::format(
      "Path of {} cells; the picture from {} shows {} free cells and {} walls", query.path.size(),
      query.cell, query.visible.free.size(), query.visible.walls.size()));
}

std::string PredictionPanel(const Segment& segment, const PerceptionAnswer& answer,
                            const std::string& title) {
  Figure figure(segment);
  figure.map.DrawMap(segment.query.belief, kFaintCells);
  for (std::size_t i = 0; i < answer.add.size(); ++i) {
    const Cell cell = answer.add.CellAt(i);
    DrawProbability(figure, cell, static_cast<double>(answer.add.values()[i]), "add");
    DrawProbability(figure, cell, static_cast<double>(answer.remove.values()[i]), "remove");
  }
  figure.DrawCamera();
  return figure.Inline(fmt::format("{}: {:.2f} edits expected", title, ExpectedEdits(answer)));
}

std::string TruthPanel(const Segment& segment) {
  Figure figure(segment);
  figure.map.DrawMap(segment.query.belief, kFaintCells);
  const EditLabels labels = LabelsOf(segment);
  for (std::size_t i = 0; i < labels.add.size(); ++i) {
    const Cell cell = labels.add.CellAt(i);
    if (labels.add.values()[i] != 0) DrawEdit(figure, cell, "add", "+");
    if (labels.remove.values()[i] != 0) DrawEdit(figure, cell, "remove", "\u2212");
  }
  figure.DrawCamera();
  return figure.Inline(fmt::format("What was done: {} edits", EditCount(segment)));
}

}  // namespace conav::nhpm
