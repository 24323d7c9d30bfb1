#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string_view>

#include "common/grid/geometry.h"
#include "common/plot/map_panel.h"
#include "common/segments/segment.h"
#include "nhpm/evaluation/report.h"

namespace conav::nhpm {
namespace {

constexpr double kNearCells = 3.0;
constexpr double kCentreRad = 12.0 * M_PI / 180.0;
constexpr double kLateralRad = 25.0 * M_PI / 180.0;

double Distance(Cell a, Cell b) { return std::hypot(a.row - b.row, a.column - b.column); }

double OffAxis(const PerceptionQuery& query, Cell cell) {
  return std::abs(WrapAngle(HeadingTowards(query.cell, cell) - query.heading_rad));
}

/// Walls that the picture shows and the map lacks, inside the border.
std::vector<Cell> MissingWalls(const PerceptionQuery& query) {
  std::vector<Cell> missing;
  for (const Cell cell : query.visible.walls) {
    if (!query.belief.OnBorder(cell) && query.belief[cell] < 0.5F) missing.push_back(cell);
  }
  return missing;
}

/// One cell along the line of sight from the camera.
Cell SightStep(const PerceptionQuery& query, Cell cell) {
  const double distance = std::max(Distance(query.cell, cell), 1.0);
  const Cell offset = cell - query.cell;
  return {static_cast<int>(std::lround(offset.row / distance)),
          static_cast<int>(std::lround(offset.column / distance))};
}

using Indices = std::vector<std::size_t>;

/// Moves up to `count` of the indices that satisfy `wanted` to the end of `chosen`.
template <class Predicate>
void Take(Indices& from, std::size_t count, std::vector<FigureSegment>& chosen, const char* reason,
          const Predicate& wanted) {
  for (auto next = from.begin(); next != from.end() && count > 0;) {
    if (!wanted(*next)) {
      ++next;
      continue;
    }
    chosen.push_back({*next, reason});
    next = from.erase(next);
    --count;
  }
}

constexpr double kCell = 18.0;
constexpr double kLowestShown = 0.05;

constexpr std::string_view kFree = "class=\"free\"";
constexpr CellStyles kCells{.wall = "class=\"wall\"", .free = kFree, .unknown = kFree};
constexpr CellStyles kFaintCells{.wall = "class=\"faint-wall\"", .free = kFree, .unknown = kFree};

/// One panel of the figure, which fills its canvas.
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

bool ShowsMisplacedNearWall(const Segment& segment) {
  const PerceptionQuery& query = segment.query;
  const EditLabels labels = LabelsOf(segment);
  for (const Cell wall : MissingWalls(query)) {
    if (labels.add[wall] != 0 || Distance(query.cell, wall) > kNearCells) continue;
    const Cell step = SightStep(query, wall);
    for (const Cell cell : {wall + step, wall - step}) {
      const bool shown_as_wall =
          std::binary_search(query.visible.walls.begin(), query.visible.walls.end(), cell);
      if (labels.add.Contains(cell) && labels.add[cell] != 0 && !shown_as_wall) return true;
    }
  }
  return false;
}

bool ShowsPreferredFarWall(const Segment& segment) {
  const PerceptionQuery& query = segment.query;
  const EditLabels labels = LabelsOf(segment);
  const std::vector<Cell> missing = MissingWalls(query);
  return std::any_of(missing.begin(), missing.end(), [&](Cell far) {
    if (labels.add[far] == 0 || OffAxis(query, far) > kCentreRad) return false;
    const double distance = Distance(query.cell, far);
    if (distance < kNearCells) return false;
    return std::any_of(missing.begin(), missing.end(), [&](Cell near) {
      return labels.add[near] == 0 && Distance(query.cell, near) < distance &&
             OffAxis(query, near) > kLateralRad;
    });
  });
}

double Difference(const PerceptionAnswer& a, const PerceptionAnswer& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.add.size(); ++i) {
    sum += std::abs(static_cast<double>(a.add.values()[i] - b.add.values()[i]));
    sum += std::abs(static_cast<double>(a.remove.values()[i] - b.remove.values()[i]));
  }
  return sum;
}

std::vector<FigureSegment> ChooseFigureSegments(const EvaluationData& data, const ModelRow& first,
                                                const ModelRow& second, std::size_t count) {
  const std::vector<const Segment*> segments = AllSegments(data.test);
  std::vector<double> differences;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    differences.push_back(Difference(first.answers[i], second.answers[i]));
  }
  Indices order(segments.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return differences[a] > differences[b]; });
  std::vector<FigureSegment> chosen;
  Take(order, count / 3, chosen, "a near wall misplaced along the line of sight",
       [&](std::size_t i) { return ShowsMisplacedNearWall(*segments[i]); });
  Take(order, count / 3, chosen, "a far wall at the centre preferred to a nearer one at the side",
       [&](std::size_t i) { return ShowsPreferredFarWall(*segments[i]); });
  Take(order, count - chosen.size(), chosen, "the models differ most",
       [](std::size_t) { return true; });
  return chosen;
}

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
  return figure.Inline(fmt::format("Actual edits: {}", EditCount(segment)));
}

}  // namespace conav::nhpm
