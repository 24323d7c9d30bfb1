#include <fmt/format.h>

#include "common/segments/segment_labels.h"
#include "nhpm/evaluation/report.h"

namespace conav::nhpm {
namespace {

std::string Quoted(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string Optional(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : "";
}

}  // namespace

std::string ReportCsv(const EvaluationReport& report) {
  std::string csv =
      "model,title,origin,test_segments,mbce_all,mbce_unmasked,train_mbce_all,train_mbce_unmasked,"
      "iou_best,iou_best_boundary,iou_fixed,segment_iou_best,segment_iou_fixed,ece,"
      "expected_edits_mean,true_edits_mean,edits_correlation,checksum,about\n";
  const std::string origin = OriginText(report.data.test);
  for (const ModelRow& row : report.rows) {
    const ModelMetrics& test = row.test;
    csv += fmt::format(
        "{},{},{},{},{},{},{},{},{},{:.2f},{},{},{},{},{},{},{},{},{}\n", Quoted(row.label.key),
        Quoted(row.label.title), origin, SegmentCount(report.data.test), test.loss.all,
        test.loss.unmasked, row.train ? Optional(row.train->all) : "",
        row.train ? Optional(row.train->unmasked) : "", test.best.iou, test.best.boundary,
        test.iou_fixed, Optional(test.segment_iou_best), Optional(test.segment_iou_fixed),
        test.calibration.error, test.edits.mean_expected, test.edits.mean_true,
        Optional(test.edits.correlation), Quoted(row.identity.checksum), Quoted(row.label.about));
  }
  return csv;
}

}  // namespace conav::nhpm
