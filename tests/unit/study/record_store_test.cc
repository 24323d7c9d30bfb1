#include "study/record_store.h"

#include <catch2/catch.hpp>
#include <map>
#include <mutex>
#include <set>

#include "common/runtime/file.h"
#include "study/supervision.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"
#include "unit/study/sample_study.h"

namespace conav::study {
namespace {

using EpisodeStore = RecordStore<EpisodeRecord>;
const nlohmann::ordered_json kDesign{{"operators", 14}, {"seed", 1}};

/// A study of pieces whose player the test writes.
struct Fixture {
  template <class Play>
  Result<void> Run(const Play& play, int jobs = 1, const StopToken& stop = StopToken()) {
    auto store = EpisodeStore::Open(*folder, "episodes");
    REQUIRE(store);
    const std::function<EpisodeRecord(int, std::size_t)> player = [&](int, std::size_t index) {
      return play(names[index]);
    };
    auto done = RunPieces(names, jobs, player, *store, stop,
                          [this](const PieceProgress& now) { progress = now; });
    records = store->records();
    return done;
  }

  test::TemporaryFolder parent;
  Result<StudyFolder> folder = StudyFolder::Open(parent / "study", kDesign);
  const std::vector<std::string> names{"a", "b", "c", "d", "e"};
  PieceProgress progress;
  Records records;
};

EpisodeRecord Good(const std::string& name) {
  return {
      .name = name, .status = EpisodeStatus::kComplete, .measures = SampleMeasures(10.0, 400.0)};
}

EpisodeRecord Bad(const std::string& name) { return {.name = name, .detail = "sim died"}; }

TEST_CASE("All pieces run once, whatever the number of jobs", "[study]") {
  for (const int jobs : {1, 3}) {
    CAPTURE(jobs);
    Fixture study;
    std::mutex mutex;
    std::multiset<std::string> played;
    REQUIRE(study.Run(
        [&](const std::string& name) {
          const std::lock_guard lock(mutex);
          played.insert(name);
          return Good(name);
        },
        jobs));
    CHECK(played == std::multiset<std::string>(study.names.begin(), study.names.end()));
    CHECK(study.records.size() == 5);
    CHECK(study.progress.done == 5);
    CHECK(study.progress.failed == 0);
  }
}

TEST_CASE("An interrupted study resumes without the piece that was under way", "[study]") {
  Fixture study;
  StopToken stop;
  std::size_t played = 0;
  const auto play = [&](const std::string& name) {
    if (++played == 3) stop.RequestStop();
    return Good(name);
  };
  REQUIRE(study.Run(play, 1, stop));
  CHECK(study.records.size() == 2);
  CHECK(played == 3);
  REQUIRE(study.Run(play));
  CHECK(study.progress.ran == 3);
  CHECK(study.records.size() == 5);
  REQUIRE(study.Run(play));
  CHECK(played == 6);
}

TEST_CASE("A failed piece runs twice, is stored as failed, and again with the next command",
          "[study]") {
  Fixture study;
  std::map<std::string, int> played;
  REQUIRE(study.Run([&](const std::string& name) {
    const bool is_first = ++played[name] == 1;
    return name == "d" || (name == "a" && is_first) ? Bad(name) : Good(name);
  }));
  CHECK(played["d"] == 2);
  CHECK(study.records.at("d").has_failed());
  CHECK(study.records.at("d").attempts == 2);
  CHECK(study.records.at("a").is_complete());  // a second attempt that succeeds is a success
  CHECK(study.progress.failed == 1);
  int attempts = 0;
  const auto goals_left_twice = [&](const std::string& name) {
    EpisodeRecord record = Good(name);
    if (++attempts <= 2) record.status = EpisodeStatus::kGoalsLeft;
    return record;
  };
  REQUIRE(study.Run(goals_left_twice));  // goals left over are a result after the second attempt
  CHECK(study.progress.failed == 0);
  REQUIRE(study.Run(goals_left_twice));
  CHECK(attempts == 2);
}

TEST_CASE("A record that cannot be written ends the study with the reason", "[study]") {
  Fixture study;
  int played = 0;
  const auto done = study.Run([&](const std::string& name) {
    ++played;
    std::filesystem::remove(study.parent / "study/episodes");
    return Good(name);
  });
  test::CheckRefusal(done, Catch::Contains("episodes"));
  CHECK(played == 1);
  CHECK(study.records.empty());
}

TEST_CASE("Records are there again for the same design", "[study]") {
  const test::TemporaryFolder parent;
  const Records records{
      {"s01", SampleRecord("s01", SampleMeasures(10.0, 400.0))},
      {"s02", {.name = "s02", .detail = "planner died", .attempts = 2, .run = "runs/y"}}};
  for (const bool is_first : {true, false}) {
    const auto folder = StudyFolder::Open(parent / "study", kDesign);
    REQUIRE(folder);
    auto store = EpisodeStore::Open(*folder, "episodes");
    REQUIRE(store);
    CHECK(store->records() == (is_first ? Records{} : records));
    for (const auto& [name, record] : records) REQUIRE(store->Save(name, record));
  }
}

TEST_CASE("The part of a file that a kill left is no obstacle", "[study]") {
  const test::TemporaryFolder parent;
  std::filesystem::create_directory(parent / "study");
  REQUIRE(WriteFile(parent / "study/study.json.0123456789abcdef.partial", "{\"fing"));
  const auto folder = StudyFolder::Open(parent / "study", kDesign);
  REQUIRE(folder);
  REQUIRE(folder->Write("episodes/s01.json.0123456789abcdef.partial", "{\"name"));
  const auto store = EpisodeStore::Open(*folder, "episodes");
  REQUIRE(store);
  CHECK(store->records().empty());
}

TEST_CASE("A folder of another design, of other files, or in use is rejected and left alone",
          "[study]") {
  const auto rejects = [](const std::filesystem::path& path, const char* named,
                          const nlohmann::ordered_json& design = kDesign) {
    test::CheckRefusal(StudyFolder::Open(path, design), Catch::Contains(named));
  };
  const test::TemporaryFolder parent;
  const auto study = parent / "study";
  {
    const auto first = StudyFolder::Open(study, kDesign);
    REQUIRE(first);
    rejects(study, "in use");
  }
  rejects(study, "seed is 1 there, 2 here", {{"operators", 14}, {"seed", 2}});
  CHECK(StudyFolder::Open(study, kDesign));
  REQUIRE(WriteFile(study / "study.json", "{"));
  rejects(study, "study.json");

  REQUIRE(std::filesystem::create_directory(parent / "mine"));
  REQUIRE(WriteFile(parent / "mine/thesis.txt", "my thesis"));
  rejects(parent / "mine", "contains no study");
  CHECK(std::distance(std::filesystem::directory_iterator(parent / "mine"), {}) == 1);
  rejects(parent / "mine/thesis.txt", "thesis.txt");
}

/// Rejects `text` as a record, by file and reason.
template <class Record>
void CheckRejected(const std::string& text, const std::string& reason) {
  const test::TemporaryFolder parent;
  const auto folder = StudyFolder::Open(parent / "study", kDesign);
  REQUIRE(folder);
  REQUIRE(folder->Write("pieces/s01.json", text));
  CAPTURE(text);
  test::CheckRefusal(RecordStore<Record>::Open(*folder, "pieces"),
                     Catch::StartsWith((parent / "study/pieces/s01.json").string() + ": ") &&
                         Catch::Contains(reason),
                     ErrorCode::kMalformed);
}

TEST_CASE("A record that cannot be read is named, with what it lacks", "[study]") {
  const auto episode = ToJson(SampleRecord("s01", SampleMeasures(10.0, 400.0)));
  const auto trial = ToJson(SupervisionRecord{.trial = {4, "fifo", 7}});
  CheckRejected<EpisodeRecord>(episode.dump().substr(0, 20), "parse error");
  CheckRejected<SupervisionRecord>(trial.dump().substr(0, 20), "parse error");
  auto contradiction = episode;
  contradiction["measures"] = nullptr;
  CheckRejected<EpisodeRecord>(contradiction.dump(), "contradict");
  for (const auto& [key, value] : episode.items()) {
    auto lacking = episode;
    lacking.erase(key);
    if (key != "operator") CheckRejected<EpisodeRecord>(lacking.dump(), key);
  }
  for (const char* key : {"robots", "order", "failure", "pace", "workload"}) {
    auto lacking = trial;
    lacking.erase(key);
    CheckRejected<SupervisionRecord>(lacking.dump(), key);
  }
}

}  // namespace
}  // namespace conav::study
