#include "study/supervision_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/plot/axes.h"
#include "common/runtime/text.h"

namespace conav::study {
namespace {

constexpr const char* kTableKeys[] = {"goals_per_minute",      "waiting_s", "waiting_p95_s",
                                      "value_lost_per_minute", "abandoned", "utilisation",
                                      "interaction_s",         "neglect_s"};
constexpr const char* kFanOutKeys[] = {"attended_robots", "fan_out", "fan_out_with_waits",
                                       "queue_attended_robots"};
constexpr const char* kQueueKeys[] = {"utilisation", "queue_utilisation", "waiting_s",
                                      "queue_waiting_s"};

constexpr const char* kMetricKeys[] = {"goals_per_minute", "waiting_s", "value_lost_per_minute",
                                       "utilisation", "attended_robots"};

constexpr const char* kWhyNone =
    "-: no trial measured it: NT needs a robot that asks a second time, IT an answer, predictions "
    "need both.";

using Json = nlohmann::ordered_json;

std::string FigureText(const SupervisionCell& cell, const SupervisionMeasure& measure) {
  const auto mean = cell.Mean(measure);
  if (!mean) return "-";
  const auto half = cell.HalfInterval(measure);
  return half ? fmt::format("{:.2f} ±{:.2f}", *mean, *half) : fmt::format("{:.2f}", *mean);
}

template <std::size_t kCount>
ReportSection CellSection(std::string title, const char* const (&keys)[kCount],
                          const SupervisionSummary& summary) {
  ReportSection section{.title = std::move(title), .header = {"robots, order", "trials"}};
  for (const char* key : keys) section.header.emplace_back(FindMeasure(key).header);
  bool lacks_figures = false;
  for (const SupervisionCell& cell : summary.cells) {
    std::vector<std::string> row{fmt::format("{} {}", cell.robots, cell.order),
                                 fmt::format("{}", cell.records.size())};
    for (const char* key : keys) {
      row.push_back(FigureText(cell, FindMeasure(key)));
      if (row.back() == "-" && !cell.records.empty()) lacks_figures = true;
    }
    section.rows.push_back(std::move(row));
  }
  if (lacks_figures) section.remarks = {kWhyNone};
  return section;
}

/// Without spread the test is meaningless, whatever its formula gives.
bool HasTest(const statistics::Pair& pair) { return pair.t.t && std::isfinite(*pair.t.t); }

std::string PText(const statistics::Pair& pair, const std::optional<double>& p) {
  return p && HasTest(pair) ? fmt::format("{:.4f}", *p) : std::string("-");
}

ReportSection ComparisonSection(const SupervisionSummary& summary) {
  ReportSection section{.title = "Orders against each other, paired by seed",
                        .header = {"robots, measure", "first - second", "difference",
                                   "95 % interval", "p", "p (Holm)"}};
  bool lacks_tests = false;
  for (const SupervisionComparison& comparison : summary.comparisons) {
    for (const statistics::Pair& pair : comparison.pairs) {
      section.rows.push_back(
          {fmt::format("{} {}", comparison.robots, comparison.measure->key),
           fmt::format("{} - {}", pair.first, pair.second),
           fmt::format("{:.3f}", pair.t.mean_difference),
           fmt::format("[{:.3f}, {:.3f}]", pair.t.interval.low, pair.t.interval.high),
           PText(pair, pair.t.p), PText(pair, pair.t_adjusted.holm)});
      lacks_tests = lacks_tests || !HasTest(pair);
    }
  }
  section.remarks = {"Paired t tests; Holm's correction within each number of robots and measure."};
  if (lacks_tests) {
    section.remarks.push_back("-: the difference is the same for every seed: nothing to test.");
  }
  return section;
}

ReportSection SlowSection(const SupervisionSummary& summary) {
  ReportSection section{.title = "Trials in which the machine did not keep pace",
                        .header = {"trial", "share of --speed"}};
  for (const SupervisionRecord* record : summary.slow) {
    section.rows.push_back({record->trial.name(), fmt::format("{:.2f}", record->pace)});
  }
  section.remarks = {"The tables include them. Use a lower --speed or an idle machine."};
  return section;
}

ReportSection FailedSection(const SupervisionSummary& summary) {
  ReportSection section{.title = "Trials that failed", .header = {"trial", "why"}};
  for (const SupervisionRecord* record : summary.failed) {
    section.rows.push_back({record->trial.name(), record->failure});
  }
  return section;
}

Json CellJson(const SupervisionCell& cell) {
  Json json{{"robots", cell.robots}, {"order", cell.order}, {"trials", cell.records.size()}};
  for (const SupervisionMeasure& measure : SupervisionMeasures()) {
    json[fmt::format("{}_mean", measure.key)] = NumberJson(cell.Mean(measure));
    json[fmt::format("{}_half_interval", measure.key)] = NumberJson(cell.HalfInterval(measure));
  }
  return json;
}

Json PairJson(const SupervisionComparison& comparison, const statistics::Pair& pair) {
  Json json{{"robots", comparison.robots},
            {"measure", comparison.measure->key},
            {"first", pair.first},
            {"second", pair.second},
            {"mean_difference", pair.t.mean_difference},
            {"low", pair.t.interval.low},
            {"high", pair.t.interval.high}};
  json["p"] = HasTest(pair) ? NumberJson(pair.t.p) : Json();
  json["p_holm"] = HasTest(pair) ? NumberJson(pair.t_adjusted.holm) : Json();
  return json;
}

constexpr double kPanelWidth = 400.0;
constexpr double kPanelHeight = 260.0;
constexpr double kLeft = 60.0;
constexpr double kTop = 40.0;
constexpr double kPlotWidth = 310.0;
constexpr double kPlotHeight = 170.0;
constexpr double kLegendHeight = 56.0;
constexpr double kBeside = 6.0;  // pixels from one order to the next
constexpr double kRoom = 1.05;   // of the logarithmic axis on both sides, a factor
constexpr int kTicks = 5;
/// Limit on an interval, as a multiple of the largest mean; beyond it the interval is cut.
constexpr double kMostInterval = 1.5;

/// Distinct also for the colour-blind (Okabe and Ito).
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73"};
constexpr const char* kMedium = R"(font-size="12" fill="#000000" font-family="sans-serif")";
constexpr const char* kTitle = R"(font-size="13" fill="#000000" font-family="sans-serif")";

/// A predicted measure, and the line style of its prediction.
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
  double most;  // largest possible value
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

/// From 0 to the largest measured or predicted value.
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
struct PanelPlot {
  SvgCanvas& canvas;
  PixelPosition corner;
  const Panel& panel;
  const SupervisionOptions& options;
  const SupervisionSummary& summary;
  Axis robots_axis{.low = 1.0 / kRoom,
                   .high = kRoom * std::ranges::max(options.robots),
                   .step = 0.0,
                   .scale = Scale::kLogarithmic};
  PlotArea area{{corner.x + kLeft, corner.y + kTop},
                kPlotWidth,
                kPlotHeight,
                robots_axis,
                AxisOf(panel, summary),
                kDocumentPlotStyle};

  void Draw() {
    DrawAxes();
    for (std::size_t order = 0; order < options.orders.size(); ++order) {
      for (const Prediction& prediction : panel.predictions) {
        DrawLine(order, prediction.key,
                 fmt::format(R"(stroke="{}" stroke-dasharray="{}")", ColourOf(order),
                             prediction.dashes));
      }
      DrawLine(order, panel.key, fmt::format(R"(stroke="{}" stroke-width="2")", ColourOf(order)));
      DrawMeans(order);
    }
  }

  /// The orders lie next to each other.
  PixelPosition At(int robots, std::size_t order, double value) const {
    const double middle = 0.5 * static_cast<double>(options.orders.size() - 1);
    const PixelPosition at = area.At(robots, value);
    return {at.x + kBeside * (static_cast<double>(order) - middle), at.y};
  }

  void DrawAxes() {
    canvas.Text({area.corner.x, corner.y + 24.0}, panel.title, kTitle);
    area.Draw(canvas, "robots", "");
    canvas.Line(area.At(area.x.low, 0.0), area.At(area.x.high, 0.0), R"(stroke="#888888")");
    for (const int robots : options.robots) {
      area.DrawTickX(canvas, robots, std::to_string(robots));
    }
  }

  template <class Visit>
  void ForCells(std::size_t order, Visit&& visit) const {
    for (const SupervisionCell& cell : summary.cells) {
      if (cell.order == options.orders[order]) visit(cell);
    }
  }

  void DrawLine(std::size_t order, const char* key, const std::string& style) {
    std::vector<PixelPosition> positions;
    ForCells(order, [&](const SupervisionCell& cell) {
      const auto mean = cell.Mean(FindMeasure(key));
      if (mean) positions.push_back(At(cell.robots, order, *mean));
    });
    std::ranges::sort(positions, {}, &PixelPosition::x);
    if (positions.size() > 1) canvas.Polyline(positions, style);
  }

  void DrawMeans(std::size_t order) {
    const SupervisionMeasure& measure = FindMeasure(panel.key);
    ForCells(order, [&](const SupervisionCell& cell) {
      const auto mean = cell.Mean(measure);
      if (!mean) return;
      const auto half = cell.HalfInterval(measure);
      canvas.BeginGroup(fmt::format("{} robots, {}: {:.2f}{}", cell.robots, cell.order, *mean,
                                    half ? fmt::format(" ± {:.2f}", *half) : ""));
      if (half) {
        canvas.Line(At(cell.robots, order, *mean - *half), At(cell.robots, order, *mean + *half),
                    fmt::format(R"(stroke="{}")", ColourOf(order)));
      }
      canvas.Circle(At(cell.robots, order, *mean), 3.5,
                    fmt::format(R"(fill="{}")", ColourOf(order)));
      canvas.EndGroup();
    });
  }
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

std::string SupervisionHeadline(const SupervisionOptions& options,
                                const SupervisionSummary& summary) {
  std::size_t measured = 0;
  for (const SupervisionCell& cell : summary.cells) measured += cell.records.size();
  const auto& times = options.interaction;
  return fmt::format(
      "SIMULATED operator: robots {}, orders {}, {} seeds; {} trials of {} min of simulation time "
      "measured, {} failed. Methods {}; interaction times: picture {} s, blocked {} s, path {} s, "
      "log-normal with log-sd {}.",
      Join(options.robots, " "), Join(options.orders, " "), options.seeds, measured,
      options.minutes, summary.failed.size(), Join(Names(options.methods), " "), times.picture_s,
      times.blocked_s, times.path_s, times.log_sd);
}

std::vector<ReportSection> SupervisionSections(const SupervisionSummary& summary) {
  std::vector<ReportSection> sections{
      CellSection("Measured: mean over seeds ± half of its 95 % interval", kTableKeys, summary),
      CellSection("Fan-out: measured and predicted", kFanOutKeys, summary),
      CellSection("Utilisation and waiting: measured and predicted", kQueueKeys, summary)};
  if (!summary.comparisons.empty()) sections.push_back(ComparisonSection(summary));
  if (!summary.slow.empty()) sections.push_back(SlowSection(summary));
  if (!summary.failed.empty()) sections.push_back(FailedSection(summary));
  return sections;
}

std::string SupervisionText(const SupervisionOptions& options, const SupervisionSummary& summary) {
  return SupervisionHeadline(options, summary) + "\n" + SectionsText(SupervisionSections(summary));
}

std::string SupervisionCsv(const std::vector<SupervisionRecord>& records) {
  std::string csv = "robots,order,seed";
  for (const SupervisionMeasure& measure : SupervisionMeasures())
    csv += fmt::format(",{}", measure.key);
  csv += ",wall_s\n";
  for (const SupervisionRecord& record : records) {
    csv += fmt::format("{},{},{}", record.trial.robots, record.trial.order, record.trial.seed);
    for (const SupervisionMeasure& measure : SupervisionMeasures()) {
      csv += CsvCell(record.is_complete() ? measure.value(record) : std::nullopt);
    }
    csv += fmt::format(",{}\n", record.wall_s);
  }
  return csv;
}

nlohmann::ordered_json SupervisionJson(const SupervisionOptions& options,
                                       const SupervisionSummary& summary) {
  Json json{{"simulated", true},        {"headline", SupervisionHeadline(options, summary)},
            {"cells", Json::array()},   {"comparisons", Json::array()},
            {"failed", Json::array()},  {"slow", Json::array()},
            {"metrics", Json::object()}};
  for (const SupervisionCell& cell : summary.cells) {
    json["cells"].push_back(CellJson(cell));
    for (const char* key : kMetricKeys) {
      json["metrics"][fmt::format("{}_{}_{}", key, cell.order, cell.robots)] =
          NumberJson(cell.Mean(FindMeasure(key)));
    }
  }
  for (const SupervisionComparison& comparison : summary.comparisons) {
    for (const statistics::Pair& pair : comparison.pairs) {
      json["comparisons"].push_back(PairJson(comparison, pair));
    }
  }
  for (const SupervisionRecord* record : summary.slow) {
    json["slow"].push_back({{"trial", record->trial.name()}, {"pace", record->pace}});
  }
  for (const SupervisionRecord* record : summary.failed) {
    json["failed"].push_back({{"trial", record->trial.name()}, {"why", record->failure}});
  }
  return json;
}

std::string SupervisionPage(const SupervisionOptions& options, const SupervisionSummary& summary,
                            const ReportSection& made) {
  return Page("One operator, many robots",
              fmt::format("<p>{}</p>\n<div class=\"wide\" tabindex=\"0\">\n{}</div>\n",
                          EscapeXml(SupervisionHeadline(options, summary)),
                          SupervisionPlot(options, summary)) +
                  SectionsHtml(SupervisionSections(summary)) + SectionsHtml(std::span(&made, 1)));
}

std::string SupervisionPlot(const SupervisionOptions& options, const SupervisionSummary& summary) {
  SvgCanvas canvas;
  DrawLegend(canvas, options.orders);
  const std::vector<Panel> panels = Panels(std::ranges::max(options.robots));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const PixelPosition corner{static_cast<double>(i % 2) * kPanelWidth,
                               kLegendHeight + static_cast<double>(i / 2) * kPanelHeight};
    PanelPlot{canvas, corner, panels[i], options, summary}.Draw();
  }
  return canvas.Document(2.0 * kPanelWidth, kLegendHeight + 2.0 * kPanelHeight,
                         "Throughput, waiting, utilisation and fan-out by number of robots");
}

}  // namespace conav::study
