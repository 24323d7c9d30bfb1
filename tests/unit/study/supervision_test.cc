#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "study/study_folder.h"
#include "study/supervision_options.h"
#include "study/supervision_report.h"
#include "support/temporary_folder.h"
#include "support/xml_check.h"

namespace conav::study {
namespace {

SupervisionOptions Small() {
  SupervisionOptions options;
  options.robots = {1, 4};
  options.orders = {"priority", "fifo"};
  options.seeds = 3;
  return options;
}

/// NT 20 s, IT 10 s, half of the time busy; priority brings one more goal than FIFO.
SupervisionRecord RecordOf(const SupervisionTrial& trial) {
  SupervisionRecord record;
  record.trial = trial;
  record.minutes = 2.0;
  record.pace = 0.98;
  record.goals = 10.0 + static_cast<double>(trial.seed) + (trial.order == "priority" ? 1.0 : 0.0);
  record.workload.neglect_time_s = 20.0;
  record.workload.interaction_time_s = 10.0;
  record.workload.observed_s = 120.0;
  record.workload.busy_s = 60.0;
  record.workload.fan_out = 3.0;
  record.workload.waiting_time_s = 4.0;
  return record;
}

std::vector<SupervisionRecord> AllRecords(const SupervisionOptions& options) {
  std::vector<SupervisionRecord> records;
  for (const SupervisionTrial& trial : TrialsOf(options)) records.push_back(RecordOf(trial));
  return records;
}

TEST_CASE("Every number of robots with every order and seed", "[study][supervision]") {
  const auto trials = TrialsOf(Small());
  REQUIRE(trials.size() == 12);
  CHECK(trials[0].name() == "n01-priority-seed1");
  CHECK(trials[1].name() == "n01-fifo-seed1");
  CHECK(trials[11].name() == "n04-fifo-seed3");
}

TEST_CASE("Interaction times are parsed by name, nonsense is refused by its text",
          "[study][supervision]") {
  operators::InteractionTimeParameters times{6.0, 10.0, 12.0, 0.5};
  REQUIRE(ParseInteractionTimes("blocked=3.5,log_sd=0", times));
  CHECK(times.blocked_s == 3.5);
  CHECK(times.log_sd == 0.0);
  CHECK(times.picture_s == 6.0);
  for (const char* text :
       {"picture", "picture=", "picture=x", "picture=-1", "look=3", "picture=4s"}) {
    const auto parsed = ParseInteractionTimes(text, times);
    REQUIRE_FALSE(parsed);
    CHECK(parsed.error().text.find(text) != std::string::npos);
  }
}

TEST_CASE("Impossible options are refused by name", "[study][supervision]") {
  CHECK(Validate(Small()));
  SupervisionOptions options = Small();
  options.robots = {0};
  CHECK(Validate(options).error().text == "--robots: 0 is not in [1, 16]");
  options.robots = {1, 17};
  CHECK(Validate(options).error().text == "--robots: 17 is not in [1, 16]");
  options.robots = {4, 2, 4};
  CHECK(Validate(options).error().text == "--robots: 4 is named twice");
  options = Small();
  options.orders = {"fifo", "lifo"};
  CHECK(Validate(options).error().text ==
        "--orders: lifo is unknown; there are priority, fifo, nearest_deadline");
  options = Small();
  options.orders = {"fifo", "fifo"};
  CHECK(Validate(options).error().text == "--orders: fifo is named twice");
  options = Small();
  options.methods.clear();
  CHECK(Validate(options).error().text == "--methods: names none");
  options = Small();
  options.speed = 0.0;
  CHECK(Validate(options).error().text == "--speed: 0 is not in [0.1, 1000]");
  options = Small();
  options.dds = "mixed";
  CHECK(Validate(options).error().text == "--dds: mixed is unknown; there are cyclonedds, fastdds");
}

TEST_CASE("More seeds, numbers or orders belong to the same study, another condition does not",
          "[study][supervision]") {
  const SupervisionOptions small = Small();
  SupervisionOptions more = small;
  more.seeds = 20;
  more.robots = {1, 4, 16};
  more.orders.push_back("nearest_deadline");
  more.jobs = 2;
  CHECK(DesignOf(more) == DesignOf(small));
  SupervisionOptions other = small;
  other.interaction.blocked_s += 1.0;
  CHECK(DesignOf(other) != DesignOf(small));
  other = small;
  other.minutes += 1.0;
  CHECK(DesignOf(other) != DesignOf(small));
}

TEST_CASE("Robots fill their worlds, worlds have the methods in turn, every robot one planner",
          "[study][supervision]") {
  const test::TemporaryFolder folder;
  SupervisionOptions options = Small();
  options.robots_per_world = 2;
  const SupervisionTrial trial{3, "fifo", 2};
  const launcher::Episode episode = EpisodeFor(trial, options);
  REQUIRE(episode.robots.size() == 3);
  REQUIRE(episode.worlds.size() == 2);
  CHECK(episode.robots[2].world == "w2");
  CHECK(MethodOf(0, trial, options) == "ig-mcts");
  CHECK(MethodOf(1, trial, options) == "instruction");

  const launcher::RunFolder run(folder.path(), {}, 2);
  const auto services = PlanServices(trial, options, {}, episode, run);
  REQUIRE(services.size() == 5);
  CHECK(services[1].config.find("order: fifo") != std::string::npos);
  CHECK(services[2].config.find("order: queue") != std::string::npos);
  CHECK(services[3].config.find("w1/r2") != std::string::npos);
  CHECK(services[3].config.find("w2/r3") == std::string::npos);
  CHECK(services[4].config.find("w2/r3") != std::string::npos);
  CHECK(services[4].config.find("timeout_clock: simulation") != std::string::npos);

  const auto simulators = PlanSimulators(trial, options, {}, episode);
  REQUIRE(simulators.size() == 2);
  CHECK(simulators[0].config.find("publish_clock: true") != std::string::npos);
  CHECK(simulators[1].config.find("publish_clock: false") != std::string::npos);
  CHECK(simulators[0].config.find("stream: false") != std::string::npos);
  CHECK(simulators[1].config.find("stream: true") != std::string::npos);
}

TEST_CASE("Measures: per minute, shares, and predictions from NT and IT, by hand",
          "[study][supervision]") {
  const SupervisionRecord one = RecordOf({1, "fifo", 2});
  CHECK(FindMeasure("goals_per_minute").value(one) == 6.0);
  CHECK(FindMeasure("utilisation").value(one) == 0.5);
  CHECK(FindMeasure("fan_out").value(one) == 1.0);  // no more than there are robots
  CHECK(FindMeasure("fan_out").value(RecordOf({4, "fifo", 2})) == 3.0);
  const SupervisionRecord two = RecordOf({2, "fifo", 2});
  CHECK(FindMeasure("queue_utilisation").value(two).value() == Approx(0.6));
  CHECK(FindMeasure("queue_waiting_s").value(two).value() == Approx(10.0 / 3.0));
  CHECK(FindMeasure("queue_attended_robots").value(two).value() == Approx(1.8));
}

TEST_CASE("Cells have mean and interval, orders are compared by seed", "[study][supervision]") {
  const SupervisionOptions options = Small();
  const auto records = AllRecords(options);
  const SupervisionSummary summary = Summarise(options, records);
  REQUIRE(summary.cells.size() == 4);
  CHECK(summary.cells[0].records.size() == 3);
  CHECK(summary.cells[0].Mean(FindMeasure("goals_per_minute")).value() == Approx(6.5));
  // sd 0.5 of three, t(2) = 4.303
  CHECK(summary.cells[0].HalfInterval(FindMeasure("goals_per_minute")).value() ==
        Approx(4.3027 * 0.5 / std::sqrt(3.0)).epsilon(1e-4));
  REQUIRE(summary.comparisons.size() == 6);
  CHECK(summary.comparisons[0].pairs.at(0).t.mean_difference == Approx(0.5));
}

TEST_CASE("A failed trial is named and leaves its seed out of the comparison",
          "[study][supervision]") {
  const SupervisionOptions options = Small();
  auto records = AllRecords(options);
  records[0].failure = "sim-w1 died";
  const SupervisionSummary summary = Summarise(options, records);
  CHECK(summary.cells[0].records.size() == 2);
  REQUIRE(summary.failed.size() == 1);
  CHECK(summary.comparisons[0].pairs.at(0).t.df == 1.0);
  CHECK(SupervisionText(options, summary).find("sim-w1 died") != std::string::npos);
  const std::string csv = SupervisionCsv(records);
  CHECK(csv.find("\n1,priority,1,,") != std::string::npos);
  CHECK(csv.find("\n1,fifo,1,5.5,") != std::string::npos);
}

TEST_CASE("What no trial measured is not told as 0", "[study][supervision]") {
  SupervisionOptions options = Small();
  options.robots = {1};
  options.seeds = 1;
  auto records = AllRecords(options);
  records[0].failure = "sim-w1 died";
  const SupervisionSummary summary = Summarise(options, records);
  const auto json = SupervisionJson(options, summary);
  CHECK(json["cells"][0]["waiting_s_mean"].is_null());
  CHECK(json["metrics"]["waiting_s_priority_1"].is_null());
  CHECK(json["cells"][1]["waiting_s_mean"] == 4.0);
  CHECK(json["cells"][1]["waiting_s_half_interval"].is_null());
  const std::string text = SupervisionText(options, summary);
  CHECK_THAT(text, !Catch::Contains("0.00 ±0.00") && Catch::Contains("4.00"));
}

TEST_CASE("Without a second question there is no NT and nothing is predicted",
          "[study][supervision]") {
  SupervisionOptions options = Small();
  options.robots = {1};
  auto records = AllRecords(options);
  for (SupervisionRecord& record : records) {
    record.workload.neglect_time_s = 0.0;
    record.workload.fan_out = 1.0;
  }
  records[1].workload.waiting_time_s = 0.0;  // of fifo; and nobody asked
  const SupervisionSummary summary = Summarise(options, records);
  for (const char* key : {"neglect_s", "fan_out", "fan_out_with_waits", "queue_attended_robots",
                          "queue_utilisation", "queue_waiting_s"}) {
    CAPTURE(key);
    CHECK_FALSE(summary.cells[0].Mean(FindMeasure(key)));
  }
  CHECK(summary.cells[0].Mean(FindMeasure("interaction_s")).value() == 10.0);
  CHECK(summary.cells[1].Mean(FindMeasure("waiting_s")).value() == 4.0);  // of the two that asked
  CHECK_THAT(SupervisionText(options, summary),
             Catch::Contains("NT needs a robot that asks a second time"));
  CHECK(SupervisionJson(options, summary)["cells"][0]["queue_utilisation_mean"].is_null());
  CHECK_THAT(SupervisionCsv(records), Catch::Contains("\n1,fifo,1,5.5,,,"));
  CHECK(test::XmlError(SupervisionPlot(options, summary)) == "");
}

TEST_CASE("A difference that no seed changes is not tested", "[study][supervision]") {
  const SupervisionOptions options = Small();
  const auto records = AllRecords(options);  // priority: always half a goal per minute more
  const SupervisionSummary summary = Summarise(options, records);
  CHECK_THAT(SupervisionText(options, summary), Catch::Contains("nothing to test"));
  const auto json = SupervisionJson(options, summary);
  CHECK(json["comparisons"][0]["mean_difference"] == Approx(0.5));
  CHECK(json["comparisons"][0]["p"].is_null());
}

TEST_CASE("A trial in which the machine fell behind is named and stays in the tables",
          "[study][supervision]") {
  const SupervisionOptions options = Small();
  auto records = AllRecords(options);
  CHECK(Summarise(options, records).slow.empty());
  records[3].pace = 0.5;
  const SupervisionSummary summary = Summarise(options, records);
  REQUIRE(summary.slow.size() == 1);
  CHECK(summary.cells[3].records.size() == 3);
  const std::string text = SupervisionText(options, summary);
  CHECK(text.find("did not keep pace") != std::string::npos);
  CHECK(text.find("n04-fifo-seed1") != std::string::npos);
  CHECK(SupervisionJson(options, summary)["slow"][0]["pace"] == 0.5);
}

TEST_CASE("Text, JSON, page and plot say that the operator was simulated", "[study][supervision]") {
  const SupervisionOptions options = Small();
  const auto records = AllRecords(options);
  const SupervisionSummary summary = Summarise(options, records);
  CHECK(SupervisionText(options, summary).find("SIMULATED") != std::string::npos);
  const statistics::ReportSection made = ProvenanceSection(
      {"conav study --supervision", "0123abc", "today", "a & b"}, {{"goals", 30}});
  const std::string page = SupervisionPage(options, summary, made);
  CHECK_THAT(page, Catch::Contains("SIMULATED") && Catch::Contains("0123abc") &&
                       Catch::Contains("a &amp; b") && Catch::Contains("<td>30</td>"));
  CHECK(SupervisionPlot(options, summary).find("simulated operator") != std::string::npos);
  CHECK(test::XmlError(SupervisionPlot(options, summary)) == "");
  CHECK(test::XmlError(page) == "");
  const auto json = SupervisionJson(options, summary);
  CHECK(json["simulated"] == true);
  CHECK(json["metrics"]["goals_per_minute_priority_4"] == Approx(6.5));
  CHECK(json["cells"].size() == 4);
}

}  // namespace
}  // namespace conav::study
