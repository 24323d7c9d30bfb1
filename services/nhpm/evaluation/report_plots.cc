#include "nhpm/evaluation/report_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/svg/svg_canvas.h"

namespace conav::nhpm {
namespace {

constexpr double kSide = 200.0;
constexpr double kLeft = 44.0;
constexpr double kTop = 12.0;
constexpr double kWidth = kLeft + kSide + 14.0;
constexpr double kHeight = kTop + kSide + 44.0;

/// Square axes from 0 to `largest`, y upwards.
struct Axes {
  double largest = 1.0;
  PixelPosition At(double x, double y) const {
    return {kLeft + kSide * x / largest, kTop + kSide * (1.0 - y / largest)};
  }
};

void DrawAxes(SvgCanvas& canvas, const Axes& axes, const std::string& x_label,
              const std::string& y_label) {
  for (int i = 0; i <= 4; ++i) {
    const double value = axes.largest * i / 4;
    canvas.Line(axes.At(0, value), axes.At(axes.largest, value), "class=\"rule\"");
    canvas.Line(axes.At(value, 0), axes.At(value, axes.largest), "class=\"rule\"");
    const PixelPosition left = axes.At(0, value);
    const PixelPosition below = axes.At(value, 0);
    canvas.Text({left.x - 5, left.y + 4}, fmt::format("{:.3g}", value),
                "class=\"tick\" text-anchor=\"end\"");
    canvas.Text({below.x, below.y + 15}, fmt::format("{:.3g}", value),
                "class=\"tick\" text-anchor=\"middle\"");
  }
  canvas.Line(axes.At(0, 0), axes.At(axes.largest, axes.largest), "class=\"ideal\"");
  canvas.Text({kLeft + kSide / 2, kHeight - 8}, x_label, "class=\"label\" text-anchor=\"middle\"");
  canvas.Text({11, kTop + kSide / 2}, y_label,
              fmt::format("class=\"label\" text-anchor=\"middle\" transform=\"rotate(-90 11 {})\"",
                          kTop + kSide / 2));
}

void DrawDot(SvgCanvas& canvas, PixelPosition at, double radius, const std::string& title) {
  canvas.BeginGroup(title);
  canvas.Circle(at, radius, "class=\"dot\"");
  canvas.EndGroup();
}

}  // namespace

std::string ReliabilityPlot(const ModelRow& row) {
  SvgCanvas canvas;
  const Axes axes;
  DrawAxes(canvas, axes, "probability promised", "share edited");
  std::vector<PixelPosition> line;
  for (const ReliabilityBin& bin : row.test.calibration.bins) {
    if (bin.outputs > 0) line.push_back(axes.At(bin.mean_probability, bin.edited_share));
  }
  canvas.Polyline(line, "class=\"curve\"");
  for (const ReliabilityBin& bin : row.test.calibration.bins) {
    if (bin.outputs == 0) continue;
    DrawDot(canvas, axes.At(bin.mean_probability, bin.edited_share),
            2.0 + std::log10(static_cast<double>(bin.outputs)),
            fmt::format("{} outputs: promised {:.3f}, edited {:.3f}", bin.outputs,
                        bin.mean_probability, bin.edited_share));
  }
  return canvas.Inline(kWidth, kHeight,
                       fmt::format("Reliability of {}: expected calibration error {:.5f}",
                                   row.label.title, row.test.calibration.error));
}

double LargestEdits(const ModelRow& row) {
  double largest = 0.0;
  for (const EditBin& bin : row.test.edits.bins) {
    largest = std::max({largest, bin.mean_expected, bin.mean_true});
  }
  return largest;
}

std::string EditsPlot(const ModelRow& row, double largest) {
  SvgCanvas canvas;
  const Axes axes{std::max(largest, 1.0)};
  DrawAxes(canvas, axes, "edits expected", "edits made");
  for (const EditBin& bin : row.test.edits.bins) {
    DrawDot(canvas, axes.At(bin.mean_expected, bin.mean_true), 4.0,
            fmt::format("{} segments: expected {:.2f}, made {:.2f}", bin.segments,
                        bin.mean_expected, bin.mean_true));
  }
  return canvas.Inline(
      kWidth, kHeight,
      fmt::format("Edits to a picture by {}: {:.3f} expected, {:.3f} made", row.label.title,
                  row.test.edits.mean_expected, row.test.edits.mean_true));
}

}  // namespace conav::nhpm
