#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/plot/axes.h"
#include "common/segments/segment.h"
#include "nhpm/evaluation/report.h"

namespace conav::nhpm {
namespace {

/// The page's style sheet: colours by prefers-color-scheme, self-contained. Add and remove are blue
/// and vermilion of Okabe and Ito's palette, which colour-blind people can tell apart.
inline constexpr const char* kPageStyle = R"css(
:root { color-scheme: light dark; --paper: #ffffff; --ink: #1c1c1c; --muted: #5a5a5a;
  --rule: #d8d8d8; --wall: #4a4a4a; --faint-wall: #bdbdbd; --free: #f1f1f1; --seen: #ffe9a8;
  --add: #0072b2; --remove: #d55e00; --camera: #117a3d; --good: #117a3d; --bad: #b00020; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16181c; --ink: #ececec; --muted: #a9a9a9; --rule: #3a3d44; --wall: #b9bcc4;
    --faint-wall: #565a63; --free: #26292f; --seen: #6b5a1e; --add: #56b4e9; --remove: #ff8a3d;
    --camera: #5fd38d; --good: #5fd38d; --bad: #ff7b8a; } }
body { margin: 2rem auto; max-width: 76rem; padding: 0 1rem; background: var(--paper);
  color: var(--ink); font: 16px/1.5 system-ui, sans-serif; }
h1, h2, h3 { line-height: 1.2; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.3rem 0.7rem; border-bottom: 1px solid var(--rule); text-align: right; }
th:first-child, td:first-child, td.text { text-align: left; }
.muted, figcaption { color: var(--muted); font-size: 0.9rem; }
.origin { display: inline-block; padding: 0.1rem 0.6rem; border: 2px solid var(--remove);
  border-radius: 0.4rem; font-weight: 600; }
.pass { color: var(--good); font-weight: 600; }
.fail { color: var(--bad); font-weight: 600; }
.row { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; max-width: 18rem; }
svg { max-width: 100%; height: auto; display: block; }
.rule { stroke: var(--rule); } .ideal { stroke: var(--muted); stroke-dasharray: 5 4; }
.tick, .label { fill: var(--muted); font-size: 11px; } .label { font-size: 12px; }
.curve { stroke: var(--add); stroke-width: 2; } .dot { fill: var(--add); }
.wall { fill: var(--wall); } .faint-wall { fill: var(--faint-wall); } .free { fill: var(--free); }
.seen-free { fill: var(--seen); } .seen-wall { fill: var(--wall); stroke: var(--remove); }
.path { stroke: var(--add); stroke-width: 3; } .camera { fill: var(--camera); }
.add { fill: var(--add); } .remove { fill: var(--remove); }
.percent { fill: var(--ink); font-size: 9px; } .sign { fill: var(--paper); font-size: 17px; }
)css";

// Plots, as SVG elements with the classes of the style sheet.

constexpr double kSide = 200.0;
constexpr double kLeft = 44.0;
constexpr double kTop = 12.0;
constexpr double kWidth = kLeft + kSide + 14.0;
constexpr double kHeight = kTop + kSide + 44.0;

/// A square plot with the same axis for x and y, and its diagonal.
PlotArea DrawAxes(SvgCanvas& canvas, const Axis& axis, const char* x_label, const char* y_label) {
  const PlotArea area{{kLeft, kTop}, kSide, kSide, axis, axis, {}, kLeft - 11.0};
  area.Draw(canvas, x_label, y_label);
  canvas.Line(area.At(axis.low, axis.low), area.At(axis.high, axis.high), "class=\"ideal\"");
  return area;
}

void DrawDot(SvgCanvas& canvas, PixelPosition at, double radius, const std::string& title) {
  canvas.BeginGroup(title);
  canvas.Circle(at, radius, "class=\"dot\"");
  canvas.EndGroup();
}

/// The largest number of edits in the bins of a row.
double LargestEdits(const ModelRow& row) {
  double largest = 0.0;
  for (const EditBin& bin : row.test.edits.bins) {
    largest = std::max({largest, bin.mean_expected, bin.mean_true});
  }
  return largest;
}

/// Actual edits over expected edits, a dot per bin of segments; the axes cover `largest`.
std::string EditsPlot(const ModelRow& row, double largest) {
  SvgCanvas canvas;
  const PlotArea area =
      DrawAxes(canvas, RoundAxis(0.0, std::max(largest, 1.0), 4), "expected edits", "actual edits");
  for (const EditBin& bin : row.test.edits.bins) {
    DrawDot(canvas, area.At(bin.mean_expected, bin.mean_true), 4.0,
            fmt::format("{} segments: expected {:.2f}, actual {:.2f}", bin.segments,
                        bin.mean_expected, bin.mean_true));
  }
  return canvas.Inline(
      kWidth, kHeight,
      fmt::format("Edits per picture by {}: {:.3f} expected, {:.3f} actual", row.label.title,
                  row.test.edits.mean_expected, row.test.edits.mean_true));
}

std::string Figure(const std::string& snapshot, const std::string& caption) {
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", snapshot,
                     EscapeXml(caption));
}

std::string Head(const EvaluationReport& report) {
  return PageHead(fmt::format("How people edit their map: {} data", OriginText(report.data.test))) +
         fmt::format(
             "<p><span class=\"origin\">{} data</span></p>\n<p>{}</p>\n<p class=\"muted\">SHA-256 "
             "of the data: {}</p>\n",
             EscapeXml(OriginText(report.data.test)), EscapeXml(DescribeData(report.data)),
             EscapeXml(report.data.checksum));
}

std::string TableRow(const ModelRow& row) {
  const ModelMetrics& test = row.test;
  return fmt::format(
      "<tr><th scope=\"row\">{}</th><td>{}</td><td>{:.5f}</td><td>{:.5f}</td><td>{:.3f} @ {:.2f}"
      "</td><td>{:.3f}</td><td>{:.5f}</td><td>{:.3f}</td><td>{:.3f}</td><td>{}</td>"
      "<td class=\"text\">{}</td></tr>\n",
      EscapeXml(row.label.title),
      row.train ? fmt::format("{:.5f}", row.train->all) : std::string("n/a"), test.loss.all,
      test.loss.unmasked, test.best.iou, test.best.boundary, test.iou_fixed, test.calibration.error,
      test.edits.mean_expected, test.edits.mean_true,
      test.edits.correlation ? fmt::format("{:.2f}", *test.edits.correlation) : std::string("n/a"),
      EscapeXml(row.label.about));
}

std::string Table(const EvaluationReport& report) {
  std::string html = "<h2>Table 1</h2>\n<div class=\"wide\" tabindex=\"0\">\n<table>\n<thead><tr>";
  for (const char* title :
       {"model", "MBCE train", "MBCE test", "of unmasked", "IoU @ ideal", "IoU @ 0.5", "ECE",
        "expected edits", "actual edits", "correlation", "about"}) {
    html += fmt::format("<th scope=\"col\">{}</th>", title);
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const ModelRow& row : report.rows) html += TableRow(row);
  return html +
         "</tbody>\n</table>\n</div>\n<p class=\"muted\">MBCE: mean binary cross-entropy in nats, "
         "over all outputs (masked ones cost 0) and over those that are not masked. IoU: "
         "predicted and true edits over predicted or true ones. ECE: expected calibration error "
         "over the outputs that are not masked, ten bins.</p>\n";
}

std::string Bars(const EvaluationReport& report) {
  if (report.bars.empty()) return "";
  std::string html = "<h2>Bars</h2>\n<ul>\n";
  for (const Bar& bar : report.bars) {
    html += fmt::format("<li class=\"{}\">{}</li>\n", bar.passed() ? "pass" : "fail",
                        EscapeXml(DescribeBar(bar)));
  }
  return html + "</ul>\n";
}

std::string Plots(const EvaluationReport& report) {
  double largest = 0.0;
  for (const ModelRow& row : report.rows) largest = std::max(largest, LargestEdits(row));
  largest = std::ceil(largest);
  std::string html = "<h2>Reliability</h2>\n<div class=\"row\">\n";
  for (const ModelRow& row : report.rows)
    html += Figure(ReliabilityPlot(row.label.title, row.test.calibration), row.label.title);
  html += "</div>\n<h2>Expected against actual edits per picture</h2>\n<div class=\"row\">\n";
  for (const ModelRow& row : report.rows) html += Figure(EditsPlot(row, largest), row.label.title);
  return html + "</div>\n";
}

std::string SegmentFigure(const EvaluationReport& report, const FigureSegment& chosen) {
  const Segment& segment = *AllSegments(report.data.test)[chosen.index];
  std::string html = fmt::format("<h3>Test segment {}: {}</h3>\n<div class=\"row\">\n",
                                 chosen.index, EscapeXml(chosen.reason));
  html += Figure(BeforePanel(segment), "Input: the operator's map");
  html += Figure(ViewPanel(segment), "Input: path and picture");
  for (const char* key : {"glpf_test", "nhpm", "oracle"}) {
    const ModelRow* row = FindRow(report.rows, key);
    if (row == nullptr) continue;
    const PerceptionAnswer& answer = row->answers[chosen.index];
    html += Figure(PredictionPanel(segment, answer, row->label.title),
                   fmt::format("{}: {:.2f} edits expected, loss {:.2f} nats", row->label.title,
                               ExpectedEdits(answer), row->segment_losses[chosen.index]));
  }
  html += Figure(TruthPanel(segment), fmt::format("Actual edits: {}", EditCount(segment)));
  return html + "</div>\n";
}

std::string Figures(const EvaluationReport& report) {
  if (report.figures.empty()) return "";
  std::string html =
      "<h2>Segments</h2>\n<p class=\"muted\">Blue: a wall is added; orange: a wall is removed; "
      "numbers are percent. The green arrow is the camera.</p>\n";
  for (const FigureSegment& chosen : report.figures) html += SegmentFigure(report, chosen);
  return html;
}

}  // namespace

std::string ReliabilityPlot(const std::string& title, const Calibration& calibration) {
  SvgCanvas canvas;
  const PlotArea area = DrawAxes(canvas, {0.0, 1.0, 0.25}, "predicted probability", "edited share");
  std::vector<PixelPosition> line;
  for (const ReliabilityBin& bin : calibration.bins) {
    if (bin.outputs > 0) line.push_back(area.At(bin.mean_probability, bin.edited_share));
  }
  canvas.Polyline(line, "class=\"curve\"");
  for (const ReliabilityBin& bin : calibration.bins) {
    if (bin.outputs == 0) continue;
    DrawDot(canvas, area.At(bin.mean_probability, bin.edited_share),
            2.0 + std::log10(static_cast<double>(bin.outputs)),
            fmt::format("{} outputs: predicted {:.3f}, edited {:.3f}", bin.outputs,
                        bin.mean_probability, bin.edited_share));
  }
  return canvas.Inline(kWidth, kHeight,
                       fmt::format("Reliability of {}: expected calibration error {:.5f}", title,
                                   calibration.error));
}

std::string PageHead(const std::string& title) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
      EscapeXml(title), kPageStyle);
}

std::string ReportPage(const EvaluationReport& report) {
  return Head(report) + Table(report) + Bars(report) + Plots(report) + Figures(report) +
         "</body>\n</html>\n";
}

}  // namespace conav::nhpm
