#include "study/live_report.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <set>

#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "study/statistics/table_reader.h"
#include "support/temporary_folder.h"
#include "support/text.h"

namespace conav::study {
namespace {

using test::CountOf;

LiveForm FormWith(const Json& answers) { return {.form = "f", .step = "s", .answers = answers}; }

std::vector<std::string> Items(int count) {
  std::vector<std::string> items;
  for (int i = 1; i <= count; ++i) items.push_back("q" + std::to_string(i));
  return items;
}

Json AnswersOf(const std::vector<int>& values) {
  Json answers = Json::object();
  for (std::size_t i = 0; i < values.size(); ++i) answers["q" + std::to_string(i + 1)] = values[i];
  return answers;
}

TEST_CASE("The System Usability Scale gives 0 to 100 points", "[study][live_report]") {
  const ScoreRule sus{.kind = ScoreRule::Kind::kSus, .items = Items(10)};
  const struct {
    std::vector<int> answers;
    std::optional<double> score;
  } rows[] = {
      {{5, 1, 5, 1, 5, 1, 5, 1, 5, 1}, 100.0},
      {{1, 5, 1, 5, 1, 5, 1, 5, 1, 5}, 0.0},
      {{3, 3, 3, 3, 3, 3, 3, 3, 3, 3}, 50.0},
      // 3 + 3, 2 + 4, 4 + 1, 3 + 2, 0 + 3 = 25 steps of 2.5
      {{4, 2, 3, 1, 5, 4, 4, 3, 1, 2}, 62.5},
      {{5, 1, 5, 1, 5, 1, 5, 1, 5}, std::nullopt},     // one is missing
      {{5, 1, 5, 1, 5, 1, 5, 1, 5, 6}, std::nullopt},  // impossible
  };
  for (const auto& row : rows) {
    CHECK(Score(sus, FormWith(AnswersOf(row.answers))) == row.score);
  }
}

TEST_CASE("A mean takes all its items, reversed ones from the other end", "[study][live_report]") {
  const ScoreRule tlx{.items = Items(6)};
  CHECK(*Score(tlx, FormWith(AnswersOf({10, 20, 30, 40, 50, 75}))) == Approx(37.5));
  ScoreRule trust{.items = Items(3), .reversed = {"q2"}, .max = 7.0};
  CHECK(*Score(trust, FormWith(AnswersOf({7, 2, 5}))) == Approx(6.0));  // (7 + 6 + 5) / 3
  trust.min = 0.0;
  CHECK(*Score(trust, FormWith(AnswersOf({7, 2, 5}))) == Approx(17.0 / 3.0));
  CHECK_FALSE(Score(trust, FormWith(AnswersOf({7, 9, 5}))));
  CHECK_FALSE(Score(tlx, FormWith(AnswersOf({1, 2, 3, 4, 5}))));
  CHECK(*Score(trust, FormWith({{"q1", "7"}, {"q2", 2.0}, {"q3", "5"}})) == Approx(17.0 / 3.0));
  CHECK_FALSE(Score(trust, FormWith({{"q1", "seven"}, {"q2", 2}, {"q3", 5}})));
}

/// A study of the methods a and b on disk (synthetic).
class StudyOnDisk {
 public:
  StudyOnDisk() {
    Write("forms/own.json",
          R"({"scoring": {"liking": {"kind": "mean", "of": ["like"]}}, "elements": [
      {"type": "rating", "name": "like", "title": "Do you like it, \"really\"?", "rateMin": 1, "rateMax": 7},
      {"type": "comment", "name": "why", "title": "Why?"}]})");
  }
  const std::filesystem::path& path() const { return folder_.path(); }

  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    REQUIRE(WriteFile(folder_ / name, text));
  }

  /// Someone who did both methods, with so many steps.
  void AddParticipant(const std::string& name, int a, int b, Json changes = Json::object()) const {
    Json design{{"participant", name}, {"parts", Json::array()}};
    Json steps = Json::array();
    Add(name, design, steps, {{"kind", "study"}, {"step", "training"}, {"training", true}}, 1);
    for (const auto& [method, value] : {std::pair{"a", a}, std::pair{"b", b}}) {
      Add(name, design, steps, {{"kind", "study"}, {"step", method}, {"method", method}}, value);
      Add(name, design, steps,
          {{"kind", "form"},
           {"step", std::string(method) + "-own"},
           {"method", method},
           {"form", "forms/own.json"},
           {"answers", {{"like", 5}, {"why", "a, \"b\"\nc"}}}},
          0);
    }
    Json result{{"participant", name}, {"complete", true}, {"aborted", false}, {"steps", steps}};
    result.update(changes);
    Write(name + "/participant.json", JsonText(design));
    Write(name + "/result.json", JsonText(result));
  }

  LiveReport Report(const std::vector<std::string>& power = {}) const {
    auto study = ReadLiveStudy(path());
    REQUIRE(study);
    auto report = MakeLiveReport(*std::move(study), path(), power, {});
    REQUIRE(report);
    return *std::move(report);
  }

 private:
  void Add(const std::string& name, Json& design, Json& steps, const Json& part, int value) const {
    Json planned = part;
    planned.erase("answers");
    design["parts"].push_back(planned);
    Json result = part;
    if (part["kind"] == "study") result.update({{"duration_s", 60.0}, {"low_level_steps", value}});
    const std::string folder =
        std::to_string(steps.size() + 1) + "-" + part["step"].get<std::string>();
    Write(name + "/" + folder + "/result.json", JsonText(result));
    steps.push_back({{"step", part["step"]}, {"folder", folder}});
  }

  test::TemporaryFolder folder_;
};

const LiveParticipant& Find(const LiveStudy& study, const std::string& name) {
  const auto found = std::ranges::find(study.participants, name, &LiveParticipant::name);
  REQUIRE(found != study.participants.end());
  return *found;
}

TEST_CASE("Participants count once they are complete, the others are listed with the reason",
          "[study][live_report]") {
  const StudyOnDisk disk;
  disk.AddParticipant("P1", 100, 200);
  disk.AddParticipant("P2", 120, 210);
  disk.AddParticipant("P3", 9, 9, {{"complete", false}});
  disk.AddParticipant("P4", 9, 9, {{"complete", false}, {"aborted", true}, {"reason", "ill"}});
  disk.AddParticipant("P5", 9, 9);
  disk.Write("P5/2-a/result.json", "{");
  disk.AddParticipant("P6", 9, 9);
  disk.Write("P6/participant.json", R"({"participant": "P1", "parts": []})");
  disk.AddParticipant("P7", 9, 9, {{"steps", 3}});
  disk.Write("P8/participant.json", R"({"participant": "P8", "parts": []})");
  disk.Write("P9/result.json", R"({"steps": []})");
  const LiveReport report = disk.Report();
  const struct {
    const char* name;
    ParticipantState state;
    const char* reason;
    const char* file;
  } rows[] = {
      {"P1", ParticipantState::kComplete, "", "P1/result.json"},
      {"P3", ParticipantState::kIncomplete, "b-own", "P3/result.json"},
      {"P4", ParticipantState::kAborted, "ill", "P4/result.json"},
      {"P5", ParticipantState::kMalformed, "P5/2-a/result.json", "P5/2-a/result.json"},
      {"P6", ParticipantState::kMalformed, "P1", "P6/participant.json"},
      {"P7", ParticipantState::kMalformed, "P7/result.json", "P7/result.json"},
      {"P8", ParticipantState::kIncomplete, "no step", "P8/result.json"},
      {"P9", ParticipantState::kMalformed, "missing", "P9/participant.json"},
  };
  for (const auto& row : rows) {
    INFO(row.name);
    const LiveParticipant& participant = Find(report.study, row.name);
    CHECK(participant.state == row.state);
    CHECK_THAT(participant.reason, Catch::Contains(row.reason));
    CHECK(participant.file == row.file);
  }
  CHECK(report.study.problems.size() == 4);
  const auto& steps = report.tested.front();
  CHECK(steps.measure.key == "low_level_steps");
  REQUIRE(steps.by_method.analysis);
  CHECK(steps.by_method.analysis->table.subjects == std::vector<std::string>{"P1", "P2"});
  CHECK(steps.by_method.analysis->table.values == std::vector<double>{100, 200, 120, 210});
  CHECK(LiveJson(report)["measures"]["low_level_steps"]["methods"]["a"]["mean"] == 110.0);
  CHECK_THAT(LivePage(report), Catch::Contains("<a href=\"P5/2-a/result.json\">"));
}

TEST_CASE("Training is no trial, and forms belong to the method that the design names",
          "[study][live_report]") {
  const StudyOnDisk disk;
  disk.AddParticipant("P1", 100, 200);
  const LiveReport report = disk.Report();
  const LiveParticipant& participant = Find(report.study, "P1");
  REQUIRE(participant.trials.size() == 2);
  CHECK(participant.trials[1].position == 2);
  CHECK(participant.trials[1].forms.size() == 1);
  CHECK(participant.trials[1].forms[0].step == "b-own");
  CHECK(participant.forms.empty());
  CHECK_FALSE(report.tested.front().by_method.analysis);  // of one participant
  CHECK_THAT(LiveText(report), Catch::Contains("at least 2 are needed"));
}

TEST_CASE("Answers survive CSV, and the codebook has each column once", "[study][live_report]") {
  const StudyOnDisk disk;
  disk.AddParticipant("P1", 100, 200);
  const LiveReport report = disk.Report();
  const auto files = LiveFiles(report);
  const std::string& csv = files.at("trials.csv");
  REQUIRE(CountOf(csv, "\n") == 3);
  const std::size_t first = csv.find('\n') + 1;
  const auto header = statistics::SplitCsvRow(csv.substr(0, first - 1));
  const auto row = statistics::SplitCsvRow(csv.substr(first, csv.find('\n', first) - first));
  REQUIRE(header);
  REQUIRE(row);
  const auto at = std::ranges::find(*header, "own_why") - header->begin();
  REQUIRE(static_cast<std::size_t>(at) < row->size());
  CHECK((*row)[static_cast<std::size_t>(at)] == "a, \"b\" c");
  std::vector<std::string> described;
  const std::string& book = files.at("codebook.csv");
  for (std::size_t begin = book.find('\n') + 1; begin < book.size();) {
    const std::size_t end = book.find('\n', begin);
    const auto fields = statistics::SplitCsvRow(book.substr(begin, end - begin));
    REQUIRE(fields);
    REQUIRE(fields->size() == 6);
    described.push_back(fields->front());
    begin = end + 1;
  }
  CHECK(described == *header);
  CHECK(std::set<std::string>(header->begin(), header->end()).size() == header->size());
}

TEST_CASE("A form whose scores make no sense is refused by name", "[study][live_report]") {
  for (const char* rule : {R"({"kind": "median", "of": ["a"]})", R"({"kind": "mean", "of": []})",
                           R"({"kind": "mean"})", R"({"kind": "sus", "of": ["a"]})",
                           R"({"kind": "mean", "of": ["a"], "reversed": ["a"]})"}) {
    INFO(rule);
    const StudyOnDisk disk;
    disk.AddParticipant("P1", 1, 2);
    disk.Write("forms/odd.json", std::string(R"({"scoring": {"s": )") + rule + "}}");
    const auto study = ReadLiveStudy(disk.path());
    REQUIRE_FALSE(study);
    CHECK(study.error().code == ErrorCode::kMalformed);
    CHECK_THAT(study.error().text, Catch::Contains("odd.json"));
  }
}

TEST_CASE("What did not go as planned is listed and excludes nobody", "[study][live_report]") {
  const StudyOnDisk disk;
  disk.AddParticipant("P1", 100, 200);
  disk.Write("P1/2-a/result.json",
             R"({"kind": "study", "step": "a", "method": "a", "duration_s": 9, "timed_out": true,
                 "pauses": 2, "paused_s": 31})");
  disk.Write("P1/1-training/result.json",
             R"({"kind": "study", "step": "training", "attempt": 2, "criterion_reached": false})");
  disk.Write("P1/log.jsonl",
             "{\"event\": \"step_begun\"}\n{\"event\": \"note\", \"text\": \"cough\"}\n"
             "{\"at\": 100.5, \"event\": \"interrupted\"}\n"
             "{\"at\": 161.5, \"event\": \"step_begun\", \"resumed\": true}\n{\"ev");
  const LiveReport report = disk.Report();
  std::string all;
  for (const Deviation& deviation : Find(report.study, "P1").deviations)
    all += deviation.text + "\n";
  CHECK(all ==
        "attempt 2 did not reach the criterion\nended by its time limit\npaused 2 times, 31.0 s in "
        "all\nnote, text cough\n"
        "interrupted\nresumed 61 s after the last entry\nline 5 of the log cannot be read\n");
  CHECK(Find(report.study, "P1").counts());
}

TEST_CASE("Eye measures of pupils that do not count stay out of tables", "[study][live_report]") {
  const StudyOnDisk disk;
  disk.AddParticipant("P1", 100, 200);
  auto study = ReadLiveStudy(disk.path());
  REQUIRE(study);
  gaze::TrialMeasures eye;
  eye.pcpd_mean = 12.5;
  eye.blinks_per_min = 9.0;
  eye.dwell_share = {{"map", 0.25}};
  eye.fixations_per_min = {{"map", 30.0}};
  study->participants[0].trials[0].eye = eye;
  eye.problem = "no baseline";
  study->participants[0].trials[1].eye = eye;
  const auto report = MakeLiveReport(*std::move(study), disk.path(), {}, {});
  REQUIRE(report);
  const LiveParticipant& participant = report->study.participants[0];
  const auto value = [&](const std::string& key, std::size_t trial) {
    const auto found = std::ranges::find(report->measures, key, &LiveMeasure::key);
    REQUIRE(found != report->measures.end());
    return found->value(participant.trials[trial]);
  };
  CHECK(value("pcpd_mean", 0) == 12.5);
  CHECK_FALSE(value("pcpd_mean", 1));
  CHECK(value("blinks_per_min", 1) == 9.0);
  CHECK(value("dwell_share_map", 1) == 0.25);
  CHECK_THAT(LiveTrialsCsv(report->study, report->columns), Catch::Contains("yes,no baseline"));
}

}  // namespace
}  // namespace conav::study
