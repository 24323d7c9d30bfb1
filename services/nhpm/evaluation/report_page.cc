#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/segments/segment_labels.h"
#include "common/svg/svg_canvas.h"
#include "nhpm/evaluation/report.h"
#include "nhpm/evaluation/report_figure.h"
#include "nhpm/evaluation/report_plots.h"
#include "nhpm/evaluation/report_style.h"

namespace conav::nhpm {
namespace {

std::string Figure(const std::string& picture, const std::string& caption) {
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", picture,
                     EscapeXml(caption));
}

std::string Head(const EvaluationReport& report) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>How people edit their map: {0} data</title>\n<style>{1}</style>\n</head>\n<body>\n"
      "<h1>How people edit their map</h1>\n<p><span class=\"origin\">{0} data</span></p>\n"
      "<p>{2}</p>\n<p class=\"muted\">SHA-256 of the data: {3}</p>\n",
      EscapeXml(OriginText(report.data.test)), kPageStyle, EscapeXml(DescribeData(report.data)),
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
        "edits expected", "edits made", "correlation", "about"}) {
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
  for (const ModelRow& row : report.rows) html += Figure(ReliabilityPlot(row), row.label.title);
  html += "</div>\n<h2>Expected against made edits to a picture</h2>\n<div class=\"row\">\n";
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
  html += Figure(TruthPanel(segment), fmt::format("What was done: {} edits", EditCount(segment)));
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

std::string ReportPage(const EvaluationReport& report) {
  return Head(report) + Table(report) + Bars(report) + Plots(report) + Figures(report) +
         "</body>\n</html>\n";
}

}  // namespace conav::nhpm
