#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "study/supervision_report.h"
#include "support/refusal.h"
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

/// A finished study; the summary points into the records.
struct SupervisionFixture {
  explicit SupervisionFixture(const SupervisionOptions& wanted = Small()) : options(wanted) {
    for (const SupervisionTrial& trial : TrialsOf(options)) records.push_back(RecordOf(trial));
  }
  SupervisionSummary Summary() const { return Summarise(options, records); }
  std::string Text() const { return SupervisionText(options, Summary()); }
  nlohmann::ordered_json Json() const { return SupervisionJson(options, Summary()); }

  SupervisionOptions options;
  std::vector<SupervisionRecord> records;
};

TEST_CASE("Interaction times are parsed by name, nonsense is refused by its text", "[study]") {
  operators::InteractionTimeParameters times{6.0, 10.0, 12.0, 0.5};
  REQUIRE(ParseInteractionTimes("blocked=3.5,log_sd=0", times));
  CHECK(times.blocked_s == 3.5);
  CHECK(times.log_sd == 0.0);
  CHECK(times.picture_s == 6.0);
  for (const char* text :
       {"picture", "picture=", "picture=x", "picture=-1", "look=3", "picture=4s"}) {
    test::CheckRefusal(ParseInteractionTimes(text, times), Catch::Contains(text));
  }
}

TEST_CASE("Impossible supervision options are rejected by name and value", "[study]") {
  using O = SupervisionOptions;
  CHECK(Validate(Small()));
  for (const auto& [set, named] : std::vector<std::pair<void (*)(O&), std::string>>{
           {[](O& o) { o.robots = {0}; }, "--robots 0"},
           {[](O& o) { o.robots.push_back(17); }, "--robots 17"},
           {[](O& o) { o.robots.push_back(4); }, "--robots: 4"},
           {[](O& o) { o.orders.push_back("lifo"); }, "--orders: lifo"},
           {[](O& o) { o.orders.push_back("fifo"); }, "--orders: fifo"},
           {[](O& o) { o.speed = 0.0; }, "--speed 0"},
           {[](O& o) { o.dds = "mixed"; }, "--dds: mixed"}}) {
    O options = Small();
    set(options);
    test::CheckRefusal(Validate(options), Catch::StartsWith(named));
  }
}

TEST_CASE("More seeds, numbers or orders belong to the same study, another condition does not",
          "[study]") {
  SupervisionOptions options = Small();
  const auto design = DesignOf(options);
  options.seeds = 20;
  options.robots = {1, 4, 16};
  options.orders.push_back("nearest_deadline");
  options.jobs = 2;
  CHECK(DesignOf(options) == design);
  using O = SupervisionOptions;
  for (const auto change : std::vector<void (*)(O&)>{[](O& o) { o.minutes += 1.0; },
                                                     [](O& o) { o.interaction.blocked_s += 1.0; },
                                                     [](O& o) { --o.goals; }}) {
    O other = options;
    change(other);
    CHECK(DesignOf(other) != design);
  }
}

TEST_CASE("Robots fill their worlds, worlds have the methods in turn, every robot one planner",
          "[study]") {
  const test::TemporaryFolder folder;
  SupervisionOptions options = Small();
  options.robots_per_world = 2;
  const SupervisionTrial trial{3, "fifo", 2};
  const launcher::Episode episode = EpisodeFor(trial, options);
  REQUIRE(episode.robots.size() == 3);
  REQUIRE(episode.worlds.size() == 2);
  CHECK(episode.robots[2].world == "w2");
  CHECK(MethodOf(0, trial, options) == MethodKind::kIgMcts);
  CHECK(MethodOf(1, trial, options) == MethodKind::kInstruction);

  const launcher::RunFolder run(folder.path(), {}, 2);
  const auto services = PlanServices(trial, options, {}, episode, run);
  REQUIRE(services.size() == 5);
  const auto simulators = PlanSimulators(trial, options, {}, episode);
  REQUIRE(simulators.size() == 2);
  for (const auto& [config, part] : std::vector<std::pair<std::string, const char*>>{
           {services[1].config, "order: fifo"},
           {services[2].config, "order: queue"},
           {services[3].config, "w1/r2"},
           {services[4].config, "w2/r3"},
           {services[4].config, "timeout_clock: simulation"},
           {simulators[0].config, "publish_clock: true"},
           {simulators[1].config, "publish_clock: false"},
           {simulators[0].config, "stream: false"},
           {simulators[1].config, "stream: true"}}) {
    CHECK_THAT(config, Catch::Contains(part));
  }
  CHECK_THAT(services[3].config, !Catch::Contains("w2/r3"));
}

TEST_CASE("Measures: per minute, shares, and predictions from NT and IT, by hand", "[study]") {
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

TEST_CASE("Numbers of robots and orders have mean and interval, orders are compared by seed",
          "[study]") {
  const SupervisionFixture study;
  REQUIRE(study.records.size() == 12);
  CHECK(study.records[1].trial.name() == "n01-fifo-seed1");
  CHECK(study.records[11].trial.name() == "n04-fifo-seed3");
  const SupervisionSummary summary = study.Summary();
  REQUIRE(summary.cells.size() == 4);
  CHECK(summary.cells[0].records.size() == 3);
  CHECK(summary.cells[0].Mean(FindMeasure("goals_per_minute")).value() == Approx(6.5));
  // sd 0.5 of three, t(2) = 4.303
  CHECK(summary.cells[0].HalfInterval(FindMeasure("goals_per_minute")).value() ==
        Approx(4.3027 * 0.5 / std::sqrt(3.0)).epsilon(1e-4));
  REQUIRE(summary.comparisons.size() == 6);
  CHECK(summary.comparisons[0].pairs.at(0).t.mean_difference == Approx(0.5));
}

TEST_CASE("A failed trial is named and left out with its seed, a slow one is named and stays",
          "[study]") {
  SupervisionFixture study;
  CHECK(study.Summary().slow.empty());
  study.records[0].failure = "sim-w1 died";
  study.records[3].pace = 0.5;
  const SupervisionSummary summary = study.Summary();
  CHECK(summary.cells[0].records.size() == 2);
  CHECK(summary.cells[3].records.size() == 3);
  REQUIRE(summary.failed.size() == 1);
  REQUIRE(summary.slow.size() == 1);
  CHECK(summary.comparisons[0].pairs.at(0).t.df == 1.0);
  CHECK_THAT(study.Text(), Catch::Contains("sim-w1 died") && Catch::Contains("n04-fifo-seed1"));
  CHECK(study.Json()["slow"][0]["pace"] == 0.5);
  CHECK_THAT(SupervisionCsv(study.records),
             Catch::Contains("\n1,priority,1,,") && Catch::Contains("\n1,fifo,1,5.5,"));
}

TEST_CASE("Figures that no trial measured, or no seed changes, are null", "[study]") {
  const auto same = SupervisionFixture().Json();  // priority: always half a goal per minute more
  CHECK(same["comparisons"][0]["mean_difference"] == Approx(0.5));
  CHECK(same["comparisons"][0]["p"].is_null());
  SupervisionOptions options = Small();
  options.robots = {1};
  options.seeds = 1;
  SupervisionFixture study(options);
  study.records[0].failure = "sim-w1 died";
  const auto json = study.Json();
  CHECK(json["cells"][0]["waiting_s_mean"].is_null());
  CHECK(json["metrics"]["waiting_s_priority_1"].is_null());
  CHECK(json["cells"][1]["waiting_s_mean"] == 4.0);
  CHECK(json["cells"][1]["waiting_s_half_interval"].is_null());
  CHECK_THAT(study.Text(), !Catch::Contains("0.00 ±0.00"));
}

TEST_CASE("Without a second question there is no NT and nothing is predicted", "[study]") {
  SupervisionOptions options = Small();
  options.robots = {1};
  SupervisionFixture study(options);
  for (SupervisionRecord& record : study.records) {
    record.workload.neglect_time_s = 0.0;
    record.workload.fan_out = 1.0;
  }
  study.records[1].workload.waiting_time_s = 0.0;  // of fifo; and nobody asked
  const SupervisionSummary summary = study.Summary();
  for (const char* key : {"neglect_s", "fan_out", "fan_out_with_waits", "queue_attended_robots",
                          "queue_utilisation", "queue_waiting_s"}) {
    CAPTURE(key);
    CHECK_FALSE(summary.cells[0].Mean(FindMeasure(key)));
  }
  CHECK(summary.cells[0].Mean(FindMeasure("interaction_s")).value() == 10.0);
  CHECK(summary.cells[1].Mean(FindMeasure("waiting_s")).value() == 4.0);  // of the two that asked
  CHECK_THAT(study.Text(), Catch::Contains("NT needs a robot that asks a second time"));
  CHECK(study.Json()["cells"][0]["queue_utilisation_mean"].is_null());
  CHECK_THAT(SupervisionCsv(study.records), Catch::Contains("\n1,fifo,1,5.5,,,"));
  CHECK(test::XmlError(SupervisionPlot(study.options, summary)) == "");
}

TEST_CASE("Text, JSON, page and plot say that the operator was simulated", "[study]") {
  const SupervisionFixture study;
  CHECK_THAT(study.Text(), Catch::Contains("SIMULATED"));
  const ReportSection made = ProvenanceSection(
      {"conav study --supervision", "0123abc", "today", "a & b"}, {{"goals", 30}});
  const std::string page = SupervisionPage(study.options, study.Summary(), made);
  CHECK_THAT(page, Catch::Contains("SIMULATED") && Catch::Contains("0123abc") &&
                       Catch::Contains("a &amp; b") && Catch::Contains("<td>30</td>"));
  CHECK_THAT(page, Catch::Contains("simulated operator"));  // in the plot
  CHECK(test::XmlError(page) == "");
  const auto json = study.Json();
  CHECK(json["simulated"] == true);
  CHECK(json["metrics"]["goals_per_minute_priority_4"] == Approx(6.5));
  CHECK(json["cells"].size() == 4);
}

TEST_CASE("A trial's record is read back as it was written, in every field", "[study]") {
  SupervisionRecord record = RecordOf({4, "fifo", 7});
  record.failure = "sim-w1 died";
  auto json = ToJson(record);
  int value = 0;
  for (auto* part : {&json, &json["workload"]}) {
    for (auto& [key, field] : part->items()) {
      if (field.is_number_float()) field = ++value + 0.125;
      if (field.is_number_integer()) field = ++value;
    }
  }
  SupervisionRecord read;
  REQUIRE(FromJson(nlohmann::json::parse(json.dump()), read));
  json["name"] = read.trial.name();
  CHECK(ToJson(read) == json);
  CHECK(json["operator"] == "simulated");
  CHECK(value == 23);  // all fields
}

}  // namespace
}  // namespace conav::study
