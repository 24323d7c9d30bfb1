#include "nhpm/evaluation/report.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "support/text.h"
#include "support/xml_check.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

EvaluationReport SampleReport() {
  EvaluationReport report;
  report.data = SampleData();
  report.rows.push_back(*EvaluateGlpfTrain(report.data));
  report.rows.push_back(*EvaluateGlpfTest(report.data));
  EvenModel even(0.25F);
  report.rows.push_back(*EvaluateModel({"nhpm", "NHPM", "a, \"b\" <c> & d"}, even, report.data));
  ModelRow oracle = report.rows[1];
  oracle.label = {"oracle", "Oracle", "the people themselves"};
  for (double& loss : oracle.segment_losses) loss *= 0.9;
  oracle.test.loss.all *= 0.9;
  report.rows.push_back(oracle);
  report.bars = CheckBars(report.data, report.rows);
  report.figures = {{7, "chosen <by hand>"}};
  return report;
}

TEST_CASE("A bar is printed with its figure, limit and interval", "[report]") {
  Bar bar{
      .key = "k", .text = "a share", .value = 0.15, .limit = 0.2, .interval = Interval{0.1, 0.3}};
  CHECK_THAT(DescribeBar(bar), Catch::StartsWith("pass  a share: 0.150") &&
                                   Catch::Contains("0.200") && Catch::Contains("0.100 to 0.300"));
  bar = {.key = "k", .text = "IoU", .value = 0.3, .limit = 0.4, .at_most = false};
  CHECK_THAT(DescribeBar(bar), Catch::StartsWith("FAIL  IoU: 0.300") && Catch::Contains("0.400"));
}

TEST_CASE("JSON holds every figure of every model", "[report]") {
  const EvaluationReport report = SampleReport();
  const auto json = ReportJson(report);
  CHECK(json["data"]["origin"] == "synthetic");
  CHECK(json["data"]["test"]["segments"] == 40);
  CHECK(json["data"]["train"]["trajectories"] == 12);
  CHECK(json["data"]["rows"] == 9);
  CHECK(json["data"]["columns"] == 9);
  CHECK(json["data"]["split_seed"] == 5);
  const auto& nhpm = json["models"]["nhpm"];
  const ModelMetrics& test = report.rows[2].test;
  CHECK(nhpm["mbce_all"] == test.loss.all);
  CHECK(nhpm["mbce_unmasked"] == test.loss.unmasked);
  CHECK(nhpm["train_mbce_all"] == report.rows[2].train->all);
  CHECK(nhpm["iou_best"] == test.best.iou);
  CHECK(nhpm["iou_best_boundary"] == test.best.boundary);
  CHECK(nhpm["iou_best_boundary_from"] == "test");
  CHECK(nhpm["iou_fixed"] == test.iou_fixed);
  CHECK(nhpm["iou_fixed_boundary"] == 0.5);
  CHECK(nhpm["ece"] == test.calibration.error);
  CHECK(nhpm["expected_edits_mean"] == Approx(49 * 0.25));
  CHECK(nhpm["true_edits_mean"] == test.edits.mean_true);
  CHECK(nhpm["edits_correlation"].is_null());  // it always promises the same
  CHECK(nhpm["reliability"].size() == 10);
  CHECK(nhpm["reliability"][2]["outputs"] == 40 * 49);
  CHECK(json["models"]["glpf_train"]["iou_best_boundary_from"] == "train");
  CHECK(json["models"]["glpf_test"]["train_mbce_all"].is_null());
  CHECK(json["bars"]["excess_share"]["passed"] == false);
  CHECK(json["bars"]["excess_share"]["limit"] == 0.2);
  CHECK(json["figures"][0]["segment"] == 7);

  // An infinite share and the number of columns of maps of several sizes are null.
  EvaluationReport odd;
  odd.data = SampleData();
  Segment& last = odd.data.test.trajectories.back().segments.back();
  last.query.belief = last.belief_after = BeliefGrid(9, 11, 1.0F);
  odd.bars = {{.key = "share", .value = std::numeric_limits<double>::infinity()}};
  const auto nulls = ReportJson(odd);
  CHECK(nulls["data"]["rows"] == 9);
  CHECK(nulls["data"]["columns"].is_null());
  CHECK(nulls["bars"]["share"]["value"].is_null());
  CHECK(nulls["bars"]["share"]["passed"] == false);
}

TEST_CASE("CSV has a line per model, with quotes where they are needed", "[report]") {
  const std::string csv = ReportCsv(SampleReport());
  CHECK(test::CountOf(csv, "\n") == 5);
  CHECK_THAT(csv, Catch::StartsWith("model,title,origin,"));
  CHECK_THAT(csv, Catch::Contains("\nnhpm,NHPM,synthetic,40,"));
  CHECK_THAT(csv, Catch::Contains("\"a, \"\"b\"\" <c> & d\"\n"));
}

TEST_CASE("The page shows table, bars, plots and the chosen segments, and needs nothing else",
          "[report]") {
  const EvaluationReport report = SampleReport();
  const std::string page = ReportPage(report);
  CHECK(test::XmlError(page) == "");
  CHECK_THAT(page, Catch::StartsWith("<!DOCTYPE html>"));
  for (const char* foreign : {"http", "<script", "src="}) {
    CHECK_THAT(page, !Catch::Contains(foreign));
  }
  CHECK_THAT(page, Catch::Contains("prefers-color-scheme: dark"));
  for (const ModelRow& row : report.rows) {
    CHECK_THAT(page, Catch::Contains(fmt::format("<td>{:.5f}</td>", row.test.loss.all)));
    CHECK_THAT(page, Catch::Contains(fmt::format("Reliability of {}", row.label.title)));
  }
  CHECK_THAT(page, Catch::Contains("<span class=\"origin\">synthetic data</span>"));
  CHECK_THAT(page, Catch::Contains("class=\"fail\">FAIL"));
  CHECK_THAT(page, Catch::Contains("Test segment 7: chosen &lt;by hand&gt;"));
  CHECK_THAT(page, Catch::Contains("a, &quot;b&quot; &lt;c&gt; &amp; d"));
  // four reliability diagrams, four plots of edits; map, view, three models and the truth
  CHECK(test::CountOf(page, "<svg ") == 4 + 4 + 6);
  CHECK(test::CountOf(page, "role=\"img\" aria-label=\"") == 14);
  CHECK_THAT(page, Catch::Contains("NHPM: 12.25 edits expected"));
  EvaluationReport bare = report;
  bare.rows.resize(1);
  bare.bars.clear();
  bare.figures.clear();
  CHECK(test::XmlError(ReportPage(bare)) == "");
  CHECK_THAT(ReportPage(bare), !Catch::Contains("<h2>Bars") && !Catch::Contains("<h2>Segments"));
}

}  // namespace
}  // namespace conav::nhpm
