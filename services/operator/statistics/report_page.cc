#include <fmt/format.h>

#include "common/svg/svg_canvas.h"
#include "operator/statistics/report.h"
#include "operator/statistics/report_plot.h"
#include "operator/statistics/report_sections.h"

namespace conav::statistics {
namespace {

/// Colours by prefers-color-scheme, nothing from elsewhere.
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
