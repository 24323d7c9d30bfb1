#include "nhpm/training/loss_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/runtime/demand.h"
#include "common/svg/svg_canvas.h"

namespace conav::nhpm {
namespace {

constexpr double kWidth = 760.0;
constexpr double kHeight = 420.0;
constexpr double kLeft = 76.0;
constexpr double kRight = 24.0;
constexpr double kTop = 56.0;
constexpr double kBottom = 52.0;
constexpr const char* kTrainColour = "#1b6ca8";
constexpr const char* kValidationColour = "#c2541b";
constexpr const char* kLabelStyle = "font-size=\"12\" fill=\"#333333\"";

/// Where losses and epochs lie on the picture.
class Axes {
 public:
  explicit Axes(const std::vector<EpochReport>& epochs)
      : last_epoch_(std::max(2.0, static_cast<double>(epochs.size()))) {
    for (const EpochReport& epoch : epochs) {
      Include(epoch.train_loss);
      Include(epoch.validation_loss);
    }
    low_ /= 1.1;
    high_ *= 1.1;
  }

  PixelPosition At(int epoch, double loss) const {
    const double across = (epoch - 1) / (last_epoch_ - 1.0);
    const double up = std::log(std::max(loss, low_) / low_) / std::log(high_ / low_);
    return {kLeft + across * (kWidth - kLeft - kRight),
            kHeight - kBottom - up * (kHeight - kTop - kBottom)};
  }

  /// 1, 2 and 5 times powers of ten.
  std::vector<double> LossTicks() const {
    std::vector<double> ticks;
    for (int power = -12; power < 4; ++power) {
      for (const double digit : {1.0, 2.0, 5.0}) {
        const double tick = digit * std::pow(10.0, power);
        if (tick > low_ && tick < high_) ticks.push_back(tick);
      }
    }
    return ticks;
  }

  std::vector<int> EpochTicks() const {
    const int last = static_cast<int>(last_epoch_);
    const int step = std::max(1, (last + 7) / 8);
    std::vector<int> ticks{1};
    for (int epoch = step; epoch <= last; epoch += step) {
      if (epoch > 1) ticks.push_back(epoch);
    }
    return ticks;
  }

 private:
  void Include(double loss) {
    const double shown = std::max(loss, 1e-12);
    low_ = std::min(low_, shown);
    high_ = std::max(high_, shown);
  }

  double last_epoch_;
  double low_ = 1e9;
  double high_ = 1e-12;
};

void DrawAxes(SvgCanvas& canvas, const Axes& axes) {
  for (const double loss : axes.LossTicks()) {
    const double y = axes.At(1, loss).y;
    canvas.Line({kLeft, y}, {kWidth - kRight, y}, "stroke=\"#dddddd\"");
    canvas.Text({kLeft - 8, y + 4}, fmt::format("{:g}", loss),
                fmt::format("{} text-anchor=\"end\"", kLabelStyle));
  }
  const double bottom = kHeight - kBottom;
  for (const int epoch : axes.EpochTicks()) {
    const double x = axes.At(epoch, 1.0).x;
    canvas.Line({x, bottom}, {x, bottom + 5}, "stroke=\"#333333\"");
    canvas.Text({x, bottom + 19}, fmt::format("{}", epoch),
                fmt::format("{} text-anchor=\"middle\"", kLabelStyle));
  }
  canvas.Line({kLeft, bottom}, {kWidth - kRight, bottom}, "stroke=\"#333333\"");
  canvas.Text({(kLeft + kWidth - kRight) / 2, kHeight - 12}, "epoch",
              fmt::format("{} text-anchor=\"middle\"", kLabelStyle));
}

void DrawLoss(SvgCanvas& canvas, const Axes& axes, const std::vector<EpochReport>& epochs,
              double EpochReport::*loss, const char* colour) {
  std::vector<PixelPosition> line;
  for (const EpochReport& epoch : epochs) line.push_back(axes.At(epoch.epoch, epoch.*loss));
  if (line.size() == 1) line.push_back({line[0].x + 4, line[0].y});
  canvas.Polyline(line, fmt::format("stroke=\"{}\" stroke-width=\"1.8\"", colour));
}

void DrawLegend(SvgCanvas& canvas, const TrainingState& state) {
  const double x = kWidth - kRight - 250;
  canvas.Line({x, kTop + 6}, {x + 22, kTop + 6},
              fmt::format("stroke=\"{}\" stroke-width=\"3\"", kTrainColour));
  canvas.Text({x + 30, kTop + 10}, "MBCE, training", kLabelStyle);
  canvas.Line({x, kTop + 26}, {x + 22, kTop + 26},
              fmt::format("stroke=\"{}\" stroke-width=\"3\"", kValidationColour));
  canvas.Text({x + 30, kTop + 30},
              fmt::format("MBCE, validation (best {:.5f}, epoch {})", BestValidationLoss(state),
                          state.best_epoch),
              kLabelStyle);
}

}  // namespace

std::string LossCurve(const TrainingState& state, const std::string& title) {
  DEMAND(!state.epochs.empty());
  const Axes axes(state.epochs);
  SvgCanvas canvas;
  canvas.Text({kLeft, 30}, title, "font-size=\"16\" fill=\"#000000\"");
  DrawAxes(canvas, axes);
  DrawLoss(canvas, axes, state.epochs, &EpochReport::train_loss, kTrainColour);
  DrawLoss(canvas, axes, state.epochs, &EpochReport::validation_loss, kValidationColour);
  canvas.Circle(axes.At(state.best_epoch, BestValidationLoss(state)), 4.5,
                fmt::format("fill=\"{}\"", kValidationColour));
  DrawLegend(canvas, state);
  return canvas.Document(kWidth, kHeight, title);
}

}  // namespace conav::nhpm
