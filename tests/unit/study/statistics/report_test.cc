#include "study/statistics/report.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "study/statistics/analysis.h"
#include "support/text.h"
#include "support/xml_check.h"
#include "unit/study/statistics/reference_tables.h"

namespace conav::statistics {
namespace {

using test::CountOf;

Analysis AnalysisOf(ConditionTable table) {
  Analysis analysis = Analyse({std::move(table), {}}, 0.05);
  analysis.file = "t.csv";
  analysis.sha256 = "00";
  return analysis;
}

TEST_CASE("The text has every table with its figures", "[statistics]") {
  const std::string text = ReportText(AnalysisOf(ReferenceTable("ergoStool")));
  CHECK_THAT(text, Catch::StartsWith("t.csv: 9 subjects, 4 conditions\n\nConditions\n"));
  for (const char* part :
       {"none                      1     3        24  22.356  3.93e-07",
        "Greenhouse-Geisser  0.64592  1.94     15.50  22.356  3.01e-05",
        "Huynh-Feldt         0.84897  2.55     20.38  22.356  2.48e-06",
        "partial eta^2 0.73646, generalised eta^2 0.45937", "Mauchly's W 0.1796, p 0.0437",
        "T1 - T2     -3.8889  [-4.9375, -2.8403]", "chi^2 22.694, df 3, p 4.68e-05"}) {
    CHECK_THAT(text, Catch::Contains(part));
  }
  // Columns stay in line under names that are not ASCII.
  const std::string foreign =
      ReportText(AnalysisOf(MakeTable({"t\xC3\xA9l\xC3\xA9", "plain"}, {1, 2, 3, 5, 4, 4})));
  CHECK_THAT(foreign, Catch::Contains("\n  t\xC3\xA9l\xC3\xA9       3  ") &&
                          Catch::Contains("\n  plain      3  "));
}

TEST_CASE("JSON has every figure at full precision", "[statistics]") {
  const Analysis analysis = AnalysisOf(ReferenceTable("ergoStool"));
  const auto json = nlohmann::json::parse(ReportJson(analysis).dump());
  CHECK(json["schema"] == 1);
  CHECK(json["anova"]["f"] == *analysis.anova.f);
  CHECK(json["anova"]["greenhouse_geisser"]["p"] == *analysis.anova.greenhouse_geisser->p);
  CHECK(json["anova"]["mauchly"]["w"] == *analysis.anova.sphericity->mauchly_w);
  CHECK(json["conditions"][2]["condition"] == "T3");
  CHECK(json["conditions"][2]["sd"] == analysis.conditions[2].standard_deviation);
  CHECK(json["pairs"].size() == 6);
  CHECK(json["pairs"][0]["p_holm"] == *analysis.pairs[0].t_adjusted.holm);
  CHECK(json["pairs"][0]["wilcoxon"]["p"] == *analysis.pairs[0].wilcoxon.p);
  CHECK(json["pairs"][0]["shapiro_wilk"]["w"] == analysis.pairs[0].normality->w);
  CHECK(json["friedman"]["kendall_w"] == *analysis.friedman.kendall_w);
  CHECK(json["subjects"].size() == 9);
  CHECK(json["notes"].empty());
}

TEST_CASE("Infinite and missing figures are null in JSON, and a note says why", "[statistics]") {
  for (const auto& values : {std::vector<double>{1, 2, 3, 2, 3, 4},     // constant differences
                             std::vector<double>{1, 1, 1, 2, 2, 2},     // no differences
                             std::vector<double>{5, 5, 5, 5, 5, 5}}) {  // nothing varies
    const auto json = ReportJson(AnalysisOf(MakeTable({"a", "b", "c"}, values)));
    CHECK(json["anova"]["f"].is_null());
    CHECK(json["anova"]["huynh_feldt"]["epsilon"].is_null());
    CHECK(json["anova"]["mauchly"]["w"].is_null());
    CHECK(json["pairs"][0]["t"].is_null());
    CHECK(json["pairs"][0]["shapiro_wilk"]["w"].is_null());
    CHECK_FALSE(json["notes"].empty());
  }
}

TEST_CASE("Notes name subjects that are left out and corrections that do not apply",
          "[statistics]") {
  auto file = ParseTable("subject,a,b\np1,1,2\np2,2,\np3,4,3\n", "t.csv");
  REQUIRE(file);
  const auto json = ReportJson(Analyse(std::move(*file), 0.05));
  CHECK_THAT(json["notes"][0].get<std::string>(), Catch::Contains("p2 (line 3)"));
  CHECK(json["left_out"][0]["subject"] == "p2");
  CHECK(json["left_out"][0]["missing"][0] == "b");
  const Analysis two = AnalysisOf(SleepTable());  // sphericity always holds
  CHECK_THAT(ReportText(two), !Catch::Contains("Greenhouse") && Catch::Contains("Note: "));
  CHECK(ReportJson(two)["anova"]["greenhouse_geisser"]["epsilon"] == 1.0);
}

TEST_CASE("The page has the tables, the plot and nothing from elsewhere", "[statistics]") {
  const std::string page = ReportPage(AnalysisOf(MakeTable({"<a>", "b"}, {1, 2, 3, 5, 4, 4})));
  CHECK_THAT(page, Catch::StartsWith("<!DOCTYPE html>"));
  CHECK(test::XmlError(page) == "");
  CHECK_THAT(page, Catch::Contains("&lt;a&gt;"));
  CHECK_THAT(page, !Catch::Contains("<a>"));
  CHECK_THAT(page, !Catch::Contains("http"));
  CHECK(CountOf(page, "<table>") == 5);
  CHECK(CountOf(page, "class=\"subject\"") == 3);
  CHECK(CountOf(page, "class=\"mean\"") == 2);
  CHECK(CountOf(page, "class=\"within\"") == 2);
}

TEST_CASE("An axis has its label and ends where no value can be", "[statistics]") {
  const Analysis analysis = AnalysisOf(MakeTable({"a", "b"}, {0, 90, 2, 100, 90, 95}));
  CHECK_THAT(ConditionsPlot(analysis), Catch::Contains(">-100</text>"));
  const std::string share = ConditionsPlot(analysis, {"share (%)", {0.0, 100.0}});
  CHECK_THAT(share, Catch::Contains(">share (%)</text>") && Catch::Contains(">100</text>"));
  CHECK_THAT(share, !Catch::Contains(">-") && !Catch::Contains(">120</text>"));
  CHECK(test::XmlError(share) == "");
}

TEST_CASE("Values that are all the same, or very many, can be drawn", "[statistics]") {
  for (const double value : {0.0, -5.0, 1e100, 1e-100}) {
    const std::string plot =
        ConditionsPlot(AnalysisOf(MakeTable({"a", "b"}, std::vector<double>(4, value))));
    CHECK_THAT(plot, !Catch::Contains("nan") && !Catch::Contains("inf"));
    CHECK(test::XmlError(plot) == "");
  }
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) values.push_back(i % 7);
  const Analysis many = AnalysisOf(MakeTable({"a", "b"}, values));
  CHECK(CountOf(ConditionsPlot(many), "class=\"subject\"") == 200);
  CHECK_THAT(ReportPage(many), Catch::Contains("the first 200"));
}

TEST_CASE("Descriptives of ergoStool are R's", "[statistics]") {
  const auto rows = Describe(ReferenceTable("ergoStool"), 0.05);
  REQUIRE(rows.size() == 4);
  const Description& t2 = rows[1];
  CHECK(t2.condition == "T2");
  CHECK(t2.n == 9);
  CHECK(t2.mean == Near(12.4444444444444446));
  CHECK(t2.standard_deviation == Near(1.5898986690282426));
  CHECK(t2.median == 12.0);
  CHECK(t2.mean_interval.high - t2.mean == Near(1.2221043017782423));
  CHECK(t2.mean - t2.mean_interval.low == Near(1.2221043017782423));
  CHECK(rows[0].within_interval.high - rows[0].mean == Near(1.00942740210727200));
  CHECK(rows[1].within_interval.high - rows[1].mean == Near(0.75881865916269930));
  CHECK(rows[2].within_interval.high - rows[2].mean == Near(0.78014792751087803));
  CHECK(rows[3].within_interval.high - rows[3].mean == Near(0.81109083076963717));
  const auto narrow = Describe(ReferenceTable("ergoStool"), 0.1)[1].mean_interval;
  CHECK(narrow.low > t2.mean_interval.low);
  CHECK(narrow.high < t2.mean_interval.high);
  // Where subjects differ by their level only, the interval within them is a point.
  const auto levels = Describe(MakeTable({"a", "b"}, {1, 2, 11, 12, 5, 6}), 0.05);
  CHECK(levels[1].within_interval.low == Near(20.0 / 3.0));
  CHECK(levels[1].within_interval.high == Near(20.0 / 3.0));
  CHECK(levels[1].mean_interval.high > 10.0);
}

}  // namespace
}  // namespace conav::statistics
