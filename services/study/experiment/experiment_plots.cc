#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "common/plot/axes.h"
#include "study/experiment/search_experiment.h"
#include "study/experiment/tradeoff.h"

namespace conav::planner {
namespace {

constexpr double kPanel = 400.0;  // of the axes, both
constexpr double kLeft = 56.0;
constexpr double kTop = 40.0;
constexpr double kBelow = 140.0;
constexpr double kLegendEntry = 128.0;
constexpr double kBetween = 64.0;
constexpr double kMostSnapshotsShown = 40.0;
constexpr int kTicks = 6;

struct Look {
  const char* policy;
  const char* label;
  const char* color;
};

// Okabe and Ito's colours, which people with any colour vision tell apart.
constexpr Look kLooks[]{{"search", "IG-MCTS", "#000000"},
                        {"random", "random", "#e69f00"},
                        {"every", "every k moves", "#56b4e9"},
                        {"threshold", "threshold", "#d55e00"},
                        {"when_blocked", "when blocked", "#009e73"},
                        {"never", "never", "#cc79a7"},
                        {"greedy", "greedy", "#0072b2"}};

const Look& LookOf(const std::string& policy) {
  const auto* found = std::find_if(std::begin(kLooks), std::end(kLooks),
                                   [&](const Look& look) { return look.policy == policy; });
  return found == std::end(kLooks) ? kLooks[0] : *found;
}

/// What the points of one kind of operator need.
class Panel {
 public:
  Panel(SvgCanvas& canvas, double left, const TradeoffSweep& sweep,
        const std::vector<const TradeoffRow*>& rows)
      : canvas_(canvas), sweep_(sweep) {
    double snapshots = 1.0;
    double least = EffortOf(*rows.front()).interval.low;
    double most = least;
    for (const TradeoffRow* row : rows) {
      if (row->snapshots.mean > kMostSnapshotsShown) continue;
      snapshots = std::max(snapshots, row->snapshots.interval.high);
      least = std::min(least, EffortOf(*row).interval.low);
      most = std::max(most, EffortOf(*row).interval.high);
    }
    const Axis x{.low = 0.0, .high = snapshots, .scale = Scale::kSquareRoot};
    area_ = {{left, kTop}, kPanel, kPanel, x, RoundAxis(least, most, kTicks), kDocumentPlotStyle};
  }

  void DrawAxes(const std::string& title) {
    canvas_.Text({area_.corner.x, kTop - 14}, title, "font-size=\"14\" font-weight=\"bold\"");
    area_.Draw(canvas_, "pictures per episode (square-root scale)", Name(sweep_.effort));
  }

  /// Points with more pictures than the axis has room for are left out.
  void DrawPolicy(const std::string& policy, const std::vector<const TradeoffRow*>& rows) {
    const Look& look = LookOf(policy);
    std::vector<const TradeoffRow*> drawn;
    std::vector<PixelPosition> line;
    for (const TradeoffRow* row : rows) {
      if (row->snapshots.mean > kMostSnapshotsShown) continue;
      drawn.push_back(row);
      line.push_back(area_.At(row->snapshots.mean, EffortOf(*row).mean));
    }
    canvas_.Polyline(line, fmt::format("stroke=\"{}\" stroke-width=\"{}\"", look.color,
                                       policy == "search" ? 2.5 : 1.5));
    for (const TradeoffRow* row : drawn) DrawPoint(*row, look);
  }

 private:
  const Figure& EffortOf(const TradeoffRow& row) const { return row.effort(sweep_.effort); }

  void DrawPoint(const TradeoffRow& row, const Look& look) {
    const Figure& effort = EffortOf(row);
    const std::string thin = fmt::format("stroke=\"{}\" stroke-width=\"0.8\"", look.color);
    canvas_.BeginGroup(fmt::format("{}: {:.1f} pictures, {:.1f} steps, {:.1f} moves",
                                   sweep_.experiment.variants[row.point].name, row.snapshots.mean,
                                   row.steps.mean, row.moves.mean));
    canvas_.Line(area_.At(row.snapshots.interval.low, effort.mean),
                 area_.At(row.snapshots.interval.high, effort.mean), thin);
    canvas_.Line(area_.At(row.snapshots.mean, effort.interval.low),
                 area_.At(row.snapshots.mean, effort.interval.high), thin);
    canvas_.Circle(area_.At(row.snapshots.mean, effort.mean), 3.5,
                   fmt::format("fill=\"{}\"", look.color));
    DrawParameter(row, look);
    canvas_.EndGroup();
  }

  /// Of IG-MCTS below its point, of the others above.
  void DrawParameter(const TradeoffRow& row, const Look& look) {
    const TradeoffPoint& point = sweep_.points[row.point];
    if (!point.parameter) return;
    PixelPosition at = area_.At(row.snapshots.mean, EffortOf(row).mean);
    at.y += point.policy == "search" ? 15.0 : -7.0;
    canvas_.Text(at, fmt::format("{:g}", *point.parameter),
                 fmt::format("font-size=\"9\" text-anchor=\"middle\" fill=\"{}\"", look.color));
  }

  SvgCanvas& canvas_;
  const TradeoffSweep& sweep_;
  PlotArea area_;
};

/// In two rows below the axes.
void DrawLegend(SvgCanvas& canvas) {
  double x = kLeft;
  double y = kTop + kPanel + 64;
  for (const Look& look : kLooks) {
    if (x + kLegendEntry > kLeft + kPanel) {
      x = kLeft;
      y += 20;
    }
    canvas.Line({x, y}, {x + 20, y}, fmt::format("stroke=\"{}\" stroke-width=\"2\"", look.color));
    canvas.Circle({x + 10, y}, 3.5, fmt::format("fill=\"{}\"", look.color));
    canvas.Text({x + 26, y + 4}, look.label, "font-size=\"12\"");
    x += kLegendEntry;
  }
  canvas.Text({kLeft, y + 24}, "numbers: cost, probability, k or threshold of the policy",
              "font-size=\"11\" fill=\"#444444\"");
}

}  // namespace

std::string TradeoffPlot(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows) {
  SvgCanvas canvas;
  const std::size_t people = sweep.experiment.operators.size();
  double left = kLeft;
  for (std::size_t person = 0; person < people; ++person, left += kPanel + kBetween) {
    std::vector<const TradeoffRow*> of_person;
    for (const TradeoffRow& row : rows) {
      if (row.person == person) of_person.push_back(&row);
    }
    Panel panel(canvas, left, sweep, of_person);
    panel.DrawAxes(fmt::format("simulated operator: {}", sweep.experiment.operators[person]));
    for (const Look& look : kLooks) {
      std::vector<const TradeoffRow*> of_policy;
      std::copy_if(
          of_person.begin(), of_person.end(), std::back_inserter(of_policy),
          [&](const TradeoffRow* row) { return sweep.points[row->point].policy == look.policy; });
      if (!of_policy.empty()) panel.DrawPolicy(look.policy, of_policy);
    }
  }
  DrawLegend(canvas);
  return canvas.Document(left - kBetween + 24, kTop + kPanel + kBelow,
                         "Pictures against effort for each communication policy");
}

namespace {

constexpr const char* kColors[]{"#000000", "#d55e00", "#0072b2", "#009e73"};

using Rows = std::vector<const VariantSummary*>;

/// The right share of the operator's map against `cost`, a line through the variants per operator.
void DrawFrontier(SvgCanvas& canvas, double left, const SearchExperiment& experiment,
                  const std::vector<Rows>& people, Figure VariantSummary::*cost,
                  const char* label) {
  double least = (people.front().front()->*cost).mean;
  double most = least;
  for (const Rows& rows : people) {
    for (const VariantSummary* row : rows) {
      least = std::min(least, (row->*cost).mean);
      most = std::max(most, (row->*cost).mean);
    }
  }
  const PlotArea area{{left, kTop},
                      kPanel,
                      kPanel,
                      RoundAxis(least, most, kTicks, {.least = 0.0}),
                      RoundAxis(0.0, 100.0, kTicks),
                      kDocumentPlotStyle};
  area.Draw(canvas, label, "right cells of the operator's map, %");
  for (std::size_t person = 0; person < people.size(); ++person) {
    const char* color = kColors[person % std::size(kColors)];
    std::vector<PixelPosition> line;
    for (const VariantSummary* row : people[person]) {
      const PixelPosition at =
          line.emplace_back(area.At((row->*cost).mean, 100.0 * row->mapping_accuracy.mean));
      canvas.Circle(at, 3.5, fmt::format("fill=\"{}\"", color));
      if (person == 0) {
        canvas.Text({at.x + 6, at.y + 12}, experiment.variants[row->variant].name,
                    "font-size=\"9\" fill=\"#444444\"");
      }
    }
    canvas.Polyline(line, fmt::format("stroke=\"{}\" stroke-width=\"1.5\"", color));
  }
}

}  // namespace

std::string FrontierPlot(const SearchExperiment& experiment,
                         const std::vector<VariantSummary>& summaries) {
  std::vector<Rows> people(experiment.operators.size());
  for (const VariantSummary& row : summaries) people[row.person].push_back(&row);
  SvgCanvas canvas;
  DrawFrontier(canvas, kLeft, experiment, people, &VariantSummary::snapshots,
               "pictures per episode (180 KiB each)");
  DrawFrontier(canvas, kLeft + kPanel + kBetween, experiment, people, &VariantSummary::steps,
               "low-level steps");
  const double below = kTop + kPanel + 64;
  for (std::size_t person = 0; person < people.size(); ++person) {
    const double x = kLeft + 160.0 * static_cast<double>(person);
    canvas.Circle({x, below}, 3.5,
                  fmt::format("fill=\"{}\"", kColors[person % std::size(kColors)]));
    canvas.Text({x + 10, below + 4}, "simulated: " + experiment.operators[person],
                "font-size=\"12\"");
  }
  return canvas.Document(kLeft + 2 * kPanel + kBetween + 110, below + 24,
                         "The operator's map against pictures and steps for each variant");
}

}  // namespace conav::planner
