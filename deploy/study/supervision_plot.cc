#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/svg/axis.h"
#include "common/svg/svg_canvas.h"
#include "study/supervision_report.h"

namespace conav::study {
namespace {

constexpr double kPanelWidth = 400.0;
constexpr double kPanelHeight = 260.0;
constexpr double kLeft = 60.0;
constexpr double kTop = 40.0;
constexpr double kPlotWidth = 310.0;
constexpr double kPlotHeight = 170.0;
constexpr double kLegendHeight = 56.0;
constexpr double kBeside = 6.0;  // pixels from one order to the next
constexpr int kTicks = 5;
/// An interval may take so much of the axis, as a multiple of the largest mean; beyond it is cut.
constexpr double kMostInterval = 1.5;

/// Distinct also for the colour-blind (Okabe and Ito).
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73"};
constexpr const char* kSmall = R"(font-size="11" fill="#333333" font-family="sans-serif")";
constexpr const char* kMedium = R"(font-size="12" fill="#000000" font-family="sans-serif")";
constexpr const char* kTitle = R"(font-size="13" fill="#000000" font-family="sans-serif")";

/// A measure that something predicts, and how the prediction is drawn.
struct Prediction {
  const char* key;
  const char* dashes;
};
constexpr const char* kQueueDashes = "4 4";
constexpr const char* kFanOutDashes = "1 3";

struct Panel {
  const char* key;
  const char* title;
  std::vector<Prediction> predictions;
  double most;  // that the measure can be
};

std::vector<Panel> Panels(int most_robots) {
  return {
      {"goals_per_minute", "Throughput, goals per minute", {}, AxisLimits{}.most},
      {"waiting_s", "Mean waiting time, s", {{"queue_waiting_s", kQueueDashes}}, AxisLimits{}.most},
      {"utilisation",
       "Utilisation: busy share of the time",
       {{"queue_utilisation", kQueueDashes}},
       1.0},
      {"attended_robots",
       "Fan-out: robots that do not wait, mean",
       {{"queue_attended_robots", kQueueDashes}, {"fan_out", kFanOutDashes}},
       static_cast<double>(most_robots)}};
}

const char* ColourOf(std::size_t order) { return kColours[order % std::size(kColours)]; }

/// From 0 to what is measured and predicted.
Axis AxisOf(const Panel& panel, const SupervisionSummary& summary) {
  const SupervisionMeasure& measure = FindMeasure(panel.key);
  double most_mean = 0.0;
  double most = 0.0;
  for (const SupervisionCell& cell : summary.cells) {
    const double mean = cell.Mean(measure).value_or(0.0);
    most_mean = std::max(most_mean, mean);
    most = std::max(most, mean + cell.HalfInterval(measure).value_or(0.0));
    for (const Prediction& prediction : panel.predictions) {
      most_mean = std::max(most_mean, cell.Mean(FindMeasure(prediction.key)).value_or(0.0));
    }
  }
  most = std::max(most_mean, std::min(most, kMostInterval * most_mean));
  return RoundAxis(0.0, most, kTicks, {0.0, panel.most});
}

/// Draws one measure over the number of robots.
class PanelPlot {
 public:
  PanelPlot(SvgCanvas& canvas, PixelPosition corner, const Panel& panel,
            const SupervisionOptions& options, const SupervisionSummary& summary)
      : canvas_(canvas),
        corner_(corner),
        panel_(panel),
        options_(options),
        summary_(summary),
        axis_(AxisOf(panel, summary)),
        most_robots_(*std::ranges::max_element(options.robots)) {}

  void Draw() {
    DrawAxes();
    for (std::size_t order = 0; order < options_.orders.size(); ++order) {
      for (const Prediction& prediction : panel_.predictions) {
        DrawLine(order, prediction.key,
                 fmt::format(R"(stroke="{}" stroke-dasharray="{}")", ColourOf(order),
                             prediction.dashes));
      }
      DrawLine(order, panel_.key, fmt::format(R"(stroke="{}" stroke-width="2")", ColourOf(order)));
      DrawMeans(order);
    }
  }

 private:
  /// Where the number of robots stands, the orders around it.
  double X(int robots, double order) const {
    const double along = most_robots_ > 1 ? std::log2(robots) / std::log2(most_robots_) : 0.5;
    const double middle = 0.5 * static_cast<double>(options_.orders.size() - 1);
    return corner_.x + kLeft + along * kPlotWidth + kBeside * (order - middle);
  }
  double Middle(int robots) const {
    return X(robots, 0.5 * static_cast<double>(options_.orders.size() - 1));
  }
  double Y(double value) const {
    return corner_.y + kTop + (1.0 - axis_.Share(axis_.Clamp(value))) * kPlotHeight;
  }

  void DrawAxes() {
    const double left = corner_.x + kLeft;
    const double right = left + kPlotWidth;
    canvas_.Text({left, corner_.y + 24.0}, panel_.title, kTitle);
    for (const double tick : axis_.Ticks()) {
      canvas_.Line({left - kBeside, Y(tick)}, {right + kBeside, Y(tick)},
                   tick == 0.0 ? R"(stroke="#888888")" : R"(stroke="#dddddd")");
      canvas_.Text({left - 12.0, Y(tick) + 4.0}, fmt::format("{:.6g}", tick),
                   fmt::format(R"({} text-anchor="end")", kSmall));
    }
    const auto below = [&](double x, double down, const std::string& text) {
      canvas_.Text({x, Y(0.0) + down}, text, fmt::format(R"({} text-anchor="middle")", kSmall));
    };
    for (const int robots : options_.robots) below(Middle(robots), 16.0, std::to_string(robots));
    below((left + right) / 2.0, 32.0, "robots");
  }

  template <class Visit>
  void ForCells(std::size_t order, Visit&& visit) const {
    for (const SupervisionCell& cell : summary_.cells) {
      if (cell.order == options_.orders[order]) visit(cell);
    }
  }

  void DrawLine(std::size_t order, const char* key, const std::string& style) {
    std::vector<PixelPosition> positions;
    ForCells(order, [&](const SupervisionCell& cell) {
      const auto mean = cell.Mean(FindMeasure(key));
      if (mean) positions.push_back({X(cell.robots, static_cast<double>(order)), Y(*mean)});
    });
    std::ranges::sort(positions, {}, &PixelPosition::x);
    if (positions.size() > 1) canvas_.Polyline(positions, style);
  }

  void DrawMeans(std::size_t order) {
    const SupervisionMeasure& measure = FindMeasure(panel_.key);
    ForCells(order, [&](const SupervisionCell& cell) {
      const auto mean = cell.Mean(measure);
      if (!mean) return;
      const auto half = cell.HalfInterval(measure);
      const double x = X(cell.robots, static_cast<double>(order));
      canvas_.BeginGroup(fmt::format("{} robots, {}: {:.2f}{}", cell.robots, cell.order, *mean,
                                     half ? fmt::format(" ± {:.2f}", *half) : ""));
      if (half) {
        canvas_.Line({x, Y(*mean - *half)}, {x, Y(*mean + *half)},
                     fmt::format(R"(stroke="{}")", ColourOf(order)));
      }
      canvas_.Circle({x, Y(*mean)}, 3.5, fmt::format(R"(fill="{}")", ColourOf(order)));
      canvas_.EndGroup();
    });
  }

  SvgCanvas& canvas_;
  PixelPosition corner_;
  const Panel& panel_;
  const SupervisionOptions& options_;
  const SupervisionSummary& summary_;
  Axis axis_;
  int most_robots_ = 1;
};

void DrawLegend(SvgCanvas& canvas, const std::vector<std::string>& orders) {
  double x = kLeft;
  for (std::size_t order = 0; order < orders.size(); ++order) {
    canvas.Circle({x, 20.0}, 4.0, fmt::format(R"(fill="{}")", ColourOf(order)));
    canvas.Text({x + 10.0, 24.0}, orders[order], kMedium);
    x += 140.0;
  }
  canvas.Text({x, 24.0}, "simulated operator", kMedium);
  x = kLeft - 4.0;
  for (const auto& [dashes, text] : {std::pair{kQueueDashes, "predicted by M/M/1//N"},
                                     std::pair{kFanOutDashes, "predicted by NT / IT + 1"}}) {
    canvas.Line({x, 42.0}, {x + 30.0, 42.0},
                fmt::format(R"(stroke="#333333" stroke-dasharray="{}")", dashes));
    canvas.Text({x + 38.0, 46.0}, text, kMedium);
    x += 210.0;
  }
  canvas.Text({x, 46.0}, "bars: 95 % intervals of the mean, cut at the frame", kMedium);
}

}  // namespace

std::string SupervisionPlot(const SupervisionOptions& options, const SupervisionSummary& summary) {
  SvgCanvas canvas;
  DrawLegend(canvas, options.orders);
  const std::vector<Panel> panels = Panels(std::ranges::max(options.robots));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const PixelPosition corner{static_cast<double>(i % 2) * kPanelWidth,
                               kLegendHeight + static_cast<double>(i / 2) * kPanelHeight};
    PanelPlot(canvas, corner, panels[i], options, summary).Draw();
  }
  return canvas.Document(2.0 * kPanelWidth, kLegendHeight + 2.0 * kPanelHeight,
                         "Throughput, waiting, utilisation and fan-out by number of robots");
}

}  // namespace conav::study
