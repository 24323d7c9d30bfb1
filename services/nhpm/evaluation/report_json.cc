#include "nhpm/evaluation/report_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "common/segments/segment_labels.h"

namespace conav::nhpm {
namespace {

using Json = nlohmann::ordered_json;

Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json Number(const std::optional<double>& value) { return value ? Number(*value) : Json(); }

Json PartJson(const SegmentSet& set) {
  int edits = 0;
  for (const Segment* segment : AllSegments(set)) edits += EditCount(*segment);
  return {
      {"trajectories", set.trajectories.size()}, {"segments", SegmentCount(set)}, {"edits", edits}};
}

/// What all maps of the set have alike; else nothing.
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

}  // namespace

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

}  // namespace conav::nhpm
