#include "nhpm/evaluation/report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "common/segments/segment.h"

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

using Json = nlohmann::ordered_json;

Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json Number(const std::optional<double>& value) { return value ? Number(*value) : Json(); }

Json PartJson(const SegmentSet& set) {
  int edits = 0;
  for (const Segment* segment : AllSegments(set)) edits += EditCount(*segment);
  return {
      {"trajectories", set.trajectories.size()}, {"segments", SegmentCount(set)}, {"edits", edits}};
}

/// The size that all maps of the set share; else empty.
template <class Size>
Json CommonSize(const SegmentSet& set, Size&& size) {
  std::set<int> sizes;
  for (const Segment* segment : AllSegments(set)) sizes.insert(size(segment->query.belief));
  return sizes.size() == 1 ? Json(*sizes.begin()) : Json();
}

Json DataJson(const EvaluationData& data) {
  Json json;
  json["file"] = data.file;
  json["sha256"] = data.checksum;
  json["origin"] = OriginText(data.test);
  json["split_seed"] = data.split_seed ? Json(*data.split_seed) : Json();
  json["rows"] = CommonSize(data.test, [](const BeliefGrid& map) { return map.rows(); });
  json["columns"] = CommonSize(data.test, [](const BeliefGrid& map) { return map.columns(); });
  json["train"] = PartJson(data.train);
  json["test"] = PartJson(data.test);
  return json;
}

Json EditBinsJson(const EditCounts& edits) {
  Json bins = Json::array();
  for (const EditBin& bin : edits.bins) {
    bins.push_back({{"segments", bin.segments},
                    {"mean_expected", bin.mean_expected},
                    {"mean_true", bin.mean_true}});
  }
  return bins;
}

Json ModelJson(const ModelRow& row) {
  const ModelMetrics& test = row.test;
  Json json;
  json["title"] = row.label.title;
  json["about"] = row.label.about;
  json["version"] = row.identity.version;
  json["checksum"] = row.identity.checksum;
  json["mbce_all"] = test.loss.all;
  json["mbce_unmasked"] = test.loss.unmasked;
  json["train_mbce_all"] = row.train ? Json(row.train->all) : Json();
  json["train_mbce_unmasked"] = row.train ? Json(row.train->unmasked) : Json();
  json["iou_best"] = test.best.iou;
  json["iou_best_boundary"] = test.best.boundary;
  json["iou_best_boundary_from"] =
      test.boundary_source == BoundarySource::kTrain ? "train" : "test";
  json["iou_fixed"] = test.iou_fixed;
  json["iou_fixed_boundary"] = kFixedBoundary;
  json["segment_iou_best"] = Number(test.segment_iou_best);
  json["segment_iou_fixed"] = Number(test.segment_iou_fixed);
  json["ece"] = test.calibration.error;
  json["reliability"] = ReliabilityJson(test.calibration);
  json["expected_edits_mean"] = test.edits.mean_expected;
  json["true_edits_mean"] = test.edits.mean_true;
  json["edits_correlation"] = Number(test.edits.correlation);
  json["edits_bins"] = EditBinsJson(test.edits);
  return json;
}

Json BarJson(const Bar& bar) {
  return {{"text", bar.text},
          {"value", Number(bar.value)},
          {"limit", Number(bar.limit)},
          {"at_most", bar.at_most},
          {"passed", bar.passed()},
          {"low", bar.interval ? Number(bar.interval->low) : Json()},
          {"high", bar.interval ? Number(bar.interval->high) : Json()}};
}

std::string LossText(const std::optional<Loss>& loss) {
  return loss ? fmt::format("{:.5f}", loss->all) : "-";
}

std::string Counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string DescribePart(const SegmentSet& set) {
  std::size_t edits = 0;
  for (const Segment* segment : AllSegments(set)) {
    edits += static_cast<std::size_t>(EditCount(*segment));
  }
  return fmt::format("{}, {}, {}", Counted(set.trajectories.size(), "trajectory", "trajectories"),
                     Counted(SegmentCount(set), "segment", "segments"),
                     Counted(edits, "edit", "edits"));
}

std::string Line(const ModelRow& row, std::size_t width) {
  const ModelMetrics& test = row.test;
  return fmt::format(
      "{:<{}}{:>11}{:>11.5f}{:>10.5f}{:>9.3f} @ {:.2f}{:>10.3f}{:>9.5f}{:>10.3f}{:>7.3f}{:>8}\n",
      row.label.title, width, LossText(row.train), test.loss.all, test.loss.unmasked, test.best.iou,
      test.best.boundary, test.iou_fixed, test.calibration.error, test.edits.mean_expected,
      test.edits.mean_true,
      test.edits.correlation ? fmt::format("{:.2f}", *test.edits.correlation) : "-");
}

}  // namespace

Json ReliabilityJson(const Calibration& calibration) {
  Json bins = Json::array();
  for (const ReliabilityBin& bin : calibration.bins) {
    bins.push_back({{"low", bin.low},
                    {"high", bin.high},
                    {"outputs", bin.outputs},
                    {"mean_probability", bin.mean_probability},
                    {"edited_share", bin.edited_share}});
  }
  return bins;
}

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

Json ReportJson(const EvaluationReport& report) {
  Json json;
  json["schema"] = 1;
  json["data"] = DataJson(report.data);
  json["models"] = Json::object();
  for (const ModelRow& row : report.rows) json["models"][row.label.key] = ModelJson(row);
  json["bars"] = Json::object();
  for (const Bar& bar : report.bars) json["bars"][bar.key] = BarJson(bar);
  json["figures"] = Json::array();
  for (const FigureSegment& figure : report.figures) {
    json["figures"].push_back({{"segment", figure.index}, {"reason", figure.reason}});
  }
  return json;
}

std::string DescribeData(const EvaluationData& data) {
  std::string text = fmt::format("{} data, {}: test {}", OriginText(data.test), data.file,
                                 DescribePart(data.test));
  if (!data.split_seed) return text + "; the whole file is test";
  return text +
         fmt::format("; train {}; split seed {}", DescribePart(data.train), *data.split_seed);
}

std::string DescribeBar(const Bar& bar) {
  std::string text =
      fmt::format("{}  {}: {:.3f} (must be {} {:.3f}", bar.passed() ? "pass" : "FAIL", bar.text,
                  bar.value, bar.at_most ? "at most" : "more than", bar.limit);
  if (bar.interval) {
    text += fmt::format("; 90 % of test sets like this: {:.3f} to {:.3f}", bar.interval->low,
                        bar.interval->high);
  }
  return text + ")";
}

std::string ReportTable(const EvaluationReport& report) {
  std::size_t width = 14;
  for (const ModelRow& row : report.rows) width = std::max(width, row.label.title.size() + 2);
  std::string text = DescribeData(report.data) + "\n\n";
  text += fmt::format("{:<{}}{:>11}{:>11}{:>10}{:>16}{:>10}{:>9}{:>10}{:>7}{:>8}\n", "model", width,
                      "MBCE train", "MBCE test", "unmasked", "IoU @ best", "IoU @ 0.5", "ECE",
                      "expected", "edits", "correl.");
  for (const ModelRow& row : report.rows) text += Line(row, width);
  text += '\n';
  for (const ModelRow& row : report.rows) {
    text += fmt::format("{:<{}}{}\n", row.label.title, width, row.label.about);
  }
  if (!report.bars.empty()) text += '\n';
  for (const Bar& bar : report.bars) text += DescribeBar(bar) + "\n";
  return text;
}

}  // namespace conav::nhpm
