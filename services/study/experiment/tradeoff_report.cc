#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/plot/axes.h"
#include "study/experiment/tradeoff.h"
#include "study/report_page.h"

namespace conav::planner {
namespace {

using study::NumberJson;
using Json = nlohmann::ordered_json;

std::string Text(double value) {
  return std::isfinite(value) ? fmt::format("{:+.1f}", value) : "-";
}

/// "-" where the curve of IG-MCTS does not get there.
std::string Text(const TradeoffDifference& difference) {
  if (!std::isfinite(difference.value)) return "-";
  return fmt::format("{} [{}, {}]", Text(difference.value), Text(difference.interval.low),
                     Text(difference.interval.high));
}

const char* Name(TradeoffVerdict verdict) {
  constexpr const char* kNames[]{"better", "alike", "worse", "beyond"};
  return kNames[static_cast<std::size_t>(verdict)];
}

const char* Name(Effort effort) { return effort == Effort::kSteps ? "steps" : "moves"; }

std::string Line(const TradeoffSweep& sweep, const TradeoffRow& row) {
  std::string differences;
  if (row.search_less_this) {
    const TradeoffComparison& comparison = *row.search_less_this;
    differences = fmt::format("{:22}  {:22}  {}", Text(comparison.effort_at_equal_snapshots),
                              Text(comparison.snapshots_at_equal_effort), Name(comparison.verdict));
  }
  std::string line =
      fmt::format("{:14}  {:8}  {:>7}  {:18}  {:18}  {:18}  {:>8.1f}  {:>7.0f} %  {}",
                  sweep.experiment.variants[row.point].name, sweep.experiment.operators[row.person],
                  fmt::format("{}/{}", row.all_goals, row.episodes), FigureText(row.snapshots, 1),
                  FigureText(row.steps, 1), FigureText(row.moves, 1), row.guidance.mean,
                  100.0 * row.mapping_accuracy.mean, differences);
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::string Line(const TradeoffSweep& sweep, const PolicyVerdict& verdict) {
  return fmt::format(
      "{:14}  {:8}  IG-MCTS is better at {} of {} points, worse at {}, beyond its curve {}{}\n",
      verdict.policy, sweep.experiment.operators[verdict.person], verdict.better, verdict.points,
      verdict.worse, verdict.beyond, verdict.dominated() ? ": dominated" : "");
}

Json ToJson(const TradeoffDifference& difference) {
  return {{"value", NumberJson(difference.value)},
          {"low", NumberJson(difference.interval.low)},
          {"high", NumberJson(difference.interval.high)}};
}

Json ToJson(const TradeoffSweep& sweep, const TradeoffRow& row) {
  const TradeoffPoint& point = sweep.points[row.point];
  Json json{{"policy", point.policy},
            {"parameter", point.parameter ? Json(*point.parameter) : Json()},
            {"operator", sweep.experiment.operators[row.person]},
            {"episodes", row.episodes},
            {"all_goals", row.all_goals},
            {"pictures", FigureJson(row.snapshots)},
            {"steps", FigureJson(row.steps)},
            {"moves", FigureJson(row.moves)},
            {"guidance", FigureJson(row.guidance)},
            {"mapping_accuracy", FigureJson(row.mapping_accuracy)}};
  if (row.search_less_this) {
    const TradeoffComparison& comparison = *row.search_less_this;
    json["search_less_this"] = {
        {"effort_at_equal_pictures", ToJson(comparison.effort_at_equal_snapshots)},
        {"pictures_at_equal_effort", ToJson(comparison.snapshots_at_equal_effort)},
        {"verdict", Name(comparison.verdict)}};
  }
  return json;
}

/// Over the policies that send pictures.
std::string BarLine(const std::vector<PolicyVerdict>& verdicts) {
  int better = 0, points = 0;
  for (const PolicyVerdict& verdict : verdicts) {
    if (verdict.policy == "never" || verdict.policy == "greedy") continue;
    better += verdict.better;
    points += verdict.points;
  }
  return fmt::format("bar: better than every policy that sends pictures: {} of {} points: {}\n",
                     better, points, better == points ? "met" : "MISSED");
}

}  // namespace

std::string TradeoffTable(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows) {
  const SearchExperiment& experiment = sweep.experiment;
  std::string text = fmt::format(
      "SIMULATED operators, {}; means [95 % bootstrap interval].\n"
      "Steps: low-level control steps (0.25 s), estimated from moves and turning.\n"
      "Last columns: IG-MCTS (search) less this policy in {}, interpolated over its costs of a "
      "picture; '-' where it does not get there ('beyond': it nowhere sends so few).\n\n"
      "{:14}  {:8}  {:>7}  {:18}  {:18}  {:18}  {:>8}  {:>9}  {:22}  {:22}\n",
      MazesText(experiment), Name(sweep.effort), "policy", "operator", "goals", "pictures", "steps",
      "moves", "guidance", "map right", fmt::format("{}, equal pictures", Name(sweep.effort)),
      fmt::format("pictures, equal {}", Name(sweep.effort)));
  for (const TradeoffRow& row : rows) text += Line(sweep, row);
  text += "\n";
  const std::vector<PolicyVerdict> verdicts = JudgePolicies(sweep, rows);
  for (const PolicyVerdict& verdict : verdicts) text += Line(sweep, verdict);
  return text + BarLine(verdicts);
}

Json TradeoffJson(const TradeoffSweep& sweep, const std::vector<TradeoffRow>& rows) {
  const SearchExperiment& experiment = sweep.experiment;
  Json points = Json::array();
  for (const TradeoffRow& row : rows) points.push_back(ToJson(sweep, row));
  Json policies = Json::array();
  for (const PolicyVerdict& verdict : JudgePolicies(sweep, rows)) {
    policies.push_back({{"policy", verdict.policy},
                        {"operator", experiment.operators[verdict.person]},
                        {"points", verdict.points},
                        {"search_better", verdict.better},
                        {"search_worse", verdict.worse},
                        {"beyond", verdict.beyond},
                        {"dominated", verdict.dominated()}});
  }
  return {{"experiment", "tradeoff"},
          {"operators", "simulated"},
          {"preset", experiment.scenario.preset},
          {"first_seed", experiment.first_seed},
          {"seeds", experiment.seeds},
          {"effort", Name(sweep.effort)},
          {"points", std::move(points)},
          {"policies", std::move(policies)}};
}

std::string TradeoffCsv(const TradeoffSweep& sweep,
                        const std::vector<ExperimentEpisode>& episodes) {
  std::string text = fmt::format("policy,parameter,{},estimated_steps\n", kEpisodeColumns);
  for (const ExperimentEpisode& episode : episodes) {
    const TradeoffPoint& point = sweep.points[episode.variant];
    text += fmt::format("{},{},{},{:.1f}\n", point.policy,
                        point.parameter ? fmt::format("{:g}", *point.parameter) : "",
                        EpisodeCells(sweep.experiment, episode),
                        EstimatedLowLevelSteps(episode.result.moves, episode.result.turning_rad));
  }
  return text;
}

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

}  // namespace conav::planner
