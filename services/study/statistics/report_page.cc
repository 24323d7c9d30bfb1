#include <fmt/format.h>

#include <algorithm>

#include "common/plot/svg.h"
#include "study/statistics/report.h"

namespace conav::statistics {
namespace {

constexpr double kLeft = 72.0;
constexpr double kRight = 16.0;
constexpr double kTop = 12.0;
constexpr double kHeight = 320.0;  // of the axis
constexpr double kBelow = 32.0;
constexpr double kConditionWidth = 120.0;
constexpr std::size_t kMostLetters = 16;

constexpr int kTicks = 6;

/// y upwards.
double At(const Axis& axis, double value) {
  return kTop + kHeight * (1.0 - axis.Share(axis.Clamp(value)));
}

Axis AxisFor(const Analysis& analysis, const AxisLimits& limits) {
  const auto [least, most] =
      std::minmax_element(analysis.table.values.begin(), analysis.table.values.end());
  double low = *least;
  double high = *most;
  for (const Description& row : analysis.conditions) {
    low = std::min({low, row.mean_interval.low, row.within_interval.low});
    high = std::max({high, row.mean_interval.high, row.within_interval.high});
  }
  return RoundAxis(low, high, kTicks, limits);
}

double MiddleOf(std::size_t condition) {
  return kLeft + kConditionWidth * (static_cast<double>(condition) + 0.5);
}

/// At most kMostLetters characters of UTF-8.
std::string Shortened(const std::string& name) {
  std::size_t letters = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if ((static_cast<unsigned>(name[i]) & 0xC0U) == 0x80U) continue;
    if (++letters > kMostLetters) return name.substr(0, i) + "...";
  }
  return name;
}

void DrawAxes(SvgCanvas& canvas, const Axis& axis, const Analysis& analysis) {
  const std::size_t k = analysis.table.condition_count();
  const double right = kLeft + kConditionWidth * static_cast<double>(k);
  for (const double value : axis.Ticks()) {
    const double y = At(axis, value);
    canvas.Line({kLeft, y}, {right, y}, "class=\"rule\"");
    canvas.Text({kLeft - 6, y + 4}, fmt::format("{:.6g}", value),
                "class=\"tick\" text-anchor=\"end\"");
  }
  for (std::size_t j = 0; j < k; ++j) {
    canvas.BeginGroup(analysis.table.conditions[j]);
    canvas.Text({MiddleOf(j), kTop + kHeight + 20}, Shortened(analysis.table.conditions[j]),
                "class=\"label\" text-anchor=\"middle\"");
    canvas.EndGroup();
  }
}

/// Along the axis, upwards.
void DrawLabel(SvgCanvas& canvas, const std::string& label) {
  constexpr double kMiddle = kTop + kHeight / 2;
  canvas.Text({14.0, kMiddle}, label,
              fmt::format(R"x(class="label" text-anchor="middle" transform="rotate(-90 14 {})")x",
                          kMiddle));
}

void DrawSubjects(SvgCanvas& canvas, const Axis& axis, const ConditionTable& table) {
  for (std::size_t i = 0; i < std::min(table.subject_count(), kMostLines); ++i) {
    std::vector<PixelPosition> line;
    for (std::size_t j = 0; j < table.condition_count(); ++j) {
      line.push_back({MiddleOf(j), At(axis, table.At(i, j))});
    }
    canvas.BeginGroup(table.subjects[i]);
    canvas.Polyline(line, "class=\"subject\"");
    canvas.EndGroup();
  }
}

void DrawMean(SvgCanvas& canvas, const Axis& axis, double x, const Description& row) {
  canvas.BeginGroup(
      fmt::format("{}: mean {:.5g} [{:.5g}, {:.5g}], within subjects [{:.5g}, {:.5g}]",
                  row.condition, row.mean, row.mean_interval.low, row.mean_interval.high,
                  row.within_interval.low, row.within_interval.high));
  for (const double end : {row.mean_interval.low, row.mean_interval.high}) {
    if (!axis.Has(end)) continue;  // the interval extends beyond the possible values
    canvas.Line({x - 7, At(axis, end)}, {x + 7, At(axis, end)}, "class=\"interval\"");
  }
  const auto draw = [&](const Interval& interval, const char* style) {
    canvas.Line({x, At(axis, interval.low)}, {x, At(axis, interval.high)}, style);
  };
  draw(row.mean_interval, "class=\"interval\"");
  draw(row.within_interval, "class=\"within\"");
  canvas.Circle({x, At(axis, row.mean)}, 5, "class=\"mean\"");
  canvas.EndGroup();
}

/// Colours by prefers-color-scheme; self-contained.
constexpr const char* kStyle = R"css(
:root { color-scheme: light dark; --paper: #ffffff; --ink: #1c1c1c; --muted: #5a5a5a;
  --rule: #d8d8d8; --subject: #8a8a8a; --mean: #0072b2; --within: #d55e00; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16181c; --ink: #ececec; --muted: #a9a9a9; --rule: #3a3d44;
    --subject: #7d828c; --mean: #56b4e9; --within: #ff8a3d; } }
body { margin: 2rem auto; max-width: 76rem; padding: 0 1rem; background: var(--paper);
  color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
h1, h2 { line-height: 1.2; } h2 { font-size: 1.2rem; margin-top: 2rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.3rem 0.7rem; border-bottom: 1px solid var(--rule); text-align: right;
  white-space: nowrap; }
th:first-child { text-align: left; }
figure { margin: 0; } svg { display: block; }
.muted, figcaption { color: var(--muted); font-size: 0.9rem; }
.rule { stroke: var(--rule); } .tick, .label { fill: var(--muted); font-size: 12px; }
.subject { stroke: var(--subject); stroke-opacity: 0.6; }
.interval { stroke: var(--mean); stroke-width: 2; } .mean { fill: var(--mean); }
.within { stroke: var(--within); stroke-width: 6; stroke-opacity: 0.8; }
)css";

std::string Facts(const Analysis& analysis) {
  std::string html = fmt::format("<p>{}</p>\n<p class=\"muted\">SHA-256 of the data: {}</p>\n",
                                 EscapeXml(DescribeTable(analysis)), EscapeXml(analysis.sha256));
  if (analysis.notes.empty()) return html;
  html += "<ul>\n";
  for (const std::string& note : analysis.notes) html += "<li>" + EscapeXml(note) + "</li>\n";
  return html + "</ul>\n";
}

std::string Row(const std::vector<std::string>& cells, const char* first_scope, const char* tag) {
  std::string html = fmt::format("<tr><th scope=\"{}\">{}</th>", first_scope, EscapeXml(cells[0]));
  for (std::size_t c = 1; c < cells.size(); ++c) {
    html += fmt::format("<{0}>{1}</{0}>", tag, EscapeXml(cells[c]));
  }
  return html + "</tr>\n";
}

}  // namespace

std::string ConditionsPlot(const Analysis& analysis, const PlotAxis& values) {
  SvgCanvas canvas;
  const Axis axis = AxisFor(analysis, values.limits);
  DrawAxes(canvas, axis, analysis);
  if (!values.label.empty()) DrawLabel(canvas, values.label);
  DrawSubjects(canvas, axis, analysis.table);
  std::string title = "Means of the conditions:";
  for (std::size_t j = 0; j < analysis.conditions.size(); ++j) {
    DrawMean(canvas, axis, MiddleOf(j), analysis.conditions[j]);
    title +=
        fmt::format(" {} {:.5g}", analysis.conditions[j].condition, analysis.conditions[j].mean);
  }
  const auto k = static_cast<double>(analysis.conditions.size());
  return canvas.Inline(kLeft + kConditionWidth * k + kRight, kTop + kHeight + kBelow, title);
}

std::string PageHead(const std::string& title) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      EscapeXml(title), kStyle);
}

std::string PlotFigure(const Analysis& analysis, const PlotAxis& values) {
  std::string caption = fmt::format(
      "Blue: mean and its {0:.4g} % confidence interval. Orange: the {0:.4g} % interval within "
      "subjects, for comparing conditions. Grey: a line per subject",
      100.0 * (1.0 - analysis.alpha));
  if (analysis.table.subject_count() > kMostLines) {
    caption += fmt::format(", the first {}", kMostLines);
  }
  return fmt::format(
      "<figure>\n<div class=\"wide\" tabindex=\"0\">\n{}</div>\n<figcaption>{}.</figcaption>\n"
      "</figure>\n",
      ConditionsPlot(analysis, values), EscapeXml(caption));
}

std::string SectionHtml(const ReportSection& section) {
  std::string html = fmt::format(
      "<h2>{}</h2>\n<div class=\"wide\" tabindex=\"0\">\n<table>\n<thead>{}</thead>\n<tbody>\n",
      EscapeXml(section.title), Row(section.header, "col", "th"));
  for (const auto& row : section.rows) html += Row(row, "row", "td");
  html += "</tbody>\n</table>\n</div>\n";
  for (const std::string& remark : section.remarks) html += "<p>" + EscapeXml(remark) + "</p>\n";
  return html;
}

std::string ReportPage(const Analysis& analysis) {
  std::string html = PageHead("Repeated measures: " + analysis.file) + Facts(analysis);
  html += PlotFigure(analysis);
  for (const ReportSection& section : ReportSections(analysis)) html += SectionHtml(section);
  return html + "</body>\n</html>\n";
}

}  // namespace conav::statistics
