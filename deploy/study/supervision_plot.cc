#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/svg/svg_canvas.h"
#include "study/supervision_report.h"

namespace conav::study {
namespace {

constexpr double kPanelWidth = 380.0;
constexpr double kPanelHeight = 260.0;
constexpr double kLeft = 60.0;
constexpr double kTop = 40.0;
constexpr double kPlotWidth = 290.0;
constexpr double kPlotHeight = 170.0;
constexpr double kLegendHeight = 40.0;

/// Distinct also for the colour-blind (Okabe and Ito), and by their marks.
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73"};

struct Panel {
  const char* key;
  const char* predicted;  // null = none
};
constexpr Panel kPanels[] = {{"goals_per_minute", nullptr},
                             {"waiting_s", "queue_waiting_s"},
                             {"utilisation", "queue_utilisation"},
                             {"attended_robots", "queue_attended_robots"}};

/// Draws one measure over the number of robots.
class PanelPlot {
 public:
  PanelPlot(SvgCanvas& canvas, PixelPosition corner, const Panel& panel,
            const SupervisionOptions& options, const SupervisionSummary& summary)
      : canvas_(canvas), corner_(corner), panel_(panel), options_(options), summary_(summary) {
    most_robots_ = *std::ranges::max_element(options.robots);
    for (const SupervisionCell& cell : summary.cells) {
      const SupervisionMeasure& measure = FindMeasure(panel.key);
      most_ = std::max(most_, cell.Mean(measure) + cell.HalfInterval(measure));
      if (panel.predicted != nullptr) {
        most_ = std::max(most_, cell.Mean(FindMeasure(panel.predicted)));
      }
    }
    if (most_ <= 0.0) most_ = 1.0;
  }

  void Draw() {
    DrawAxes();
    for (std::size_t i = 0; i < options_.orders.size(); ++i) {
      const char* colour = kColours[i % std::size(kColours)];
      if (panel_.predicted != nullptr) {
        DrawLine(options_.orders[i], FindMeasure(panel_.predicted),
                 fmt::format(R"(fill="none" stroke="{}" stroke-dasharray="4 4")", colour));
      }
      DrawLine(options_.orders[i], FindMeasure(panel_.key),
               fmt::format(R"(fill="none" stroke="{}" stroke-width="2")", colour));
      DrawMeans(options_.orders[i], colour);
    }
  }

 private:
  PixelPosition At(double robots, double value) const {
    const double along = most_robots_ > 1 ? std::log2(robots) / std::log2(most_robots_) : 0.5;
    return {corner_.x + kLeft + along * kPlotWidth,
            corner_.y + kTop + (1.0 - value / most_) * kPlotHeight};
  }

  void DrawAxes() {
    constexpr const char* kGrey = R"(stroke="#888888")";
    constexpr const char* kLabel = R"(font-size="11" fill="#333333" font-family="sans-serif")";
    canvas_.Text({corner_.x + kLeft, corner_.y + 24.0}, FindMeasure(panel_.key).title,
                 R"(font-size="13" fill="#000000" font-family="sans-serif")");
    for (const double share : {0.0, 0.5, 1.0}) {
      const double y = At(1.0, share * most_).y;
      canvas_.Line({corner_.x + kLeft, y}, {corner_.x + kLeft + kPlotWidth, y},
                   share == 0.0 ? kGrey : R"(stroke="#dddddd")");
      canvas_.Text({corner_.x + 8.0, y + 4.0}, fmt::format("{:.3g}", share * most_), kLabel);
    }
    for (const int robots : options_.robots) {
      const PixelPosition tick = At(robots, 0.0);
      canvas_.Text({tick.x - 4.0, tick.y + 16.0}, fmt::format("{}", robots), kLabel);
    }
    canvas_.Text({corner_.x + kLeft + kPlotWidth - 40.0, At(1.0, 0.0).y + 32.0}, "robots", kLabel);
  }

  template <class Visit>
  void ForCells(const std::string& order, Visit&& visit) const {
    for (const SupervisionCell& cell : summary_.cells) {
      if (cell.order == order && !cell.records.empty()) visit(cell);
    }
  }

  void DrawLine(const std::string& order, const SupervisionMeasure& measure,
                const std::string& style) {
    std::vector<PixelPosition> positions;
    ForCells(order, [&](const SupervisionCell& cell) {
      positions.push_back(At(cell.robots, cell.Mean(measure)));
    });
    if (positions.size() > 1) canvas_.Polyline(positions, style);
  }

  void DrawMeans(const std::string& order, const char* colour) {
    const SupervisionMeasure& measure = FindMeasure(panel_.key);
    ForCells(order, [&](const SupervisionCell& cell) {
      const double mean = cell.Mean(measure);
      const double half = cell.HalfInterval(measure);
      canvas_.BeginGroup(
          fmt::format("{} robots, {}: {:.2f} ± {:.2f}", cell.robots, order, mean, half));
      canvas_.Line(At(cell.robots, std::max(0.0, mean - half)), At(cell.robots, mean + half),
                   fmt::format(R"(stroke="{}")", colour));
      canvas_.Circle(At(cell.robots, mean), 3.5, fmt::format(R"(fill="{}")", colour));
      canvas_.EndGroup();
    });
  }

  SvgCanvas& canvas_;
  PixelPosition corner_;
  Panel panel_;
  const SupervisionOptions& options_;
  const SupervisionSummary& summary_;
  int most_robots_ = 1;
  double most_ = 0.0;
};

}  // namespace

std::string SupervisionPlot(const SupervisionOptions& options, const SupervisionSummary& summary) {
  SvgCanvas canvas;
  double x = kLeft;
  for (std::size_t i = 0; i < options.orders.size(); ++i) {
    const char* colour = kColours[i % std::size(kColours)];
    canvas.Circle({x, 20.0}, 4.0, fmt::format(R"(fill="{}")", colour));
    canvas.Text({x + 10.0, 24.0}, options.orders[i],
                R"(font-size="12" fill="#000000" font-family="sans-serif")");
    x += 130.0;
  }
  canvas.Text({x, 24.0}, "simulated operator; dashed: M/M/1//N",
              R"(font-size="12" fill="#333333" font-family="sans-serif")");
  for (std::size_t i = 0; i < std::size(kPanels); ++i) {
    const PixelPosition corner{static_cast<double>(i % 2) * kPanelWidth,
                               kLegendHeight + static_cast<double>(i / 2) * kPanelHeight};
    PanelPlot(canvas, corner, kPanels[i], options, summary).Draw();
  }
  return canvas.Document(2.0 * kPanelWidth, kLegendHeight + 2.0 * kPanelHeight,
                         "Throughput, waiting, utilisation and fan-out by number of robots");
}

}  // namespace conav::study
