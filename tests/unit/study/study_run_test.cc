#include "study/study_run.h"

#include <catch2/catch.hpp>
#include <mutex>
#include <set>

#include "support/temporary_folder.h"
#include "unit/study/sample_study.h"

namespace conav::study {
namespace {

/// A study of 12 episodes whose player the test writes.
struct Fixture {
  Result<void> Run(const EpisodePlayer& play, int jobs = 1, const StopToken& stop = StopToken()) {
    auto store = OpenEpisodes(*folder);
    REQUIRE(store);
    auto done = RunEpisodes(design.episodes, jobs, play, *store, stop,
                            [this](const StudyProgress& now) { progress = now; });
    records = store->records();
    return done;
  }

  test::TemporaryFolder parent;
  Result<StudyFolder> folder = StudyFolder::Open(parent / "study", {{"seed", 1}});
  const Design design = MakeDesign({.operators = 2, .layouts = 2});
  StudyProgress progress;
  Records records;
};

EpisodeRecord Good(int, const PlannedEpisode&) {
  return {.status = EpisodeStatus::kComplete, .measures = SampleMeasures(10.0, 400.0)};
}

EpisodeRecord Bad(int, const PlannedEpisode&) { return {.detail = "sim died"}; }

TEST_CASE("All episodes run once, whatever the number of jobs", "[study]") {
  for (const int jobs : {1, 3}) {
    Fixture study;
    std::mutex mutex;
    std::multiset<std::string> played;
    REQUIRE(study.Run(
        [&](int job, const PlannedEpisode& episode) {
          const std::lock_guard lock(mutex);
          played.insert(episode.name);
          return Good(job, episode);
        },
        jobs));
    CHECK(played.size() == 12);
    CHECK(study.records.size() == 12);
    CHECK(study.progress.done == 12);
    CHECK(study.progress.failed == 0);
  }
}

TEST_CASE("An interrupted study goes on where it was", "[study]") {
  Fixture study;
  StopToken stop;
  std::vector<std::string> played;
  const auto play = [&](int job, const PlannedEpisode& episode) {
    played.push_back(episode.name);
    if (played.size() == 3) stop.RequestStop();
    return Good(job, episode);
  };
  REQUIRE(study.Run(play, 1, stop));
  CHECK(study.records.size() == 2);  // the one that was under way is not kept
  CHECK(played.size() == 3);
  REQUIRE(study.Run(play));
  CHECK(played.size() == 13);
  CHECK(study.progress.ran == 10);
  CHECK(study.records.size() == 12);
  REQUIRE(study.Run(play));
  CHECK(played.size() == 13);
}

TEST_CASE("A failed episode runs twice, is kept as failed, and again with the next command",
          "[study]") {
  Fixture study;
  const std::string victim = study.design.episodes[3].name;
  std::size_t attempts = 0;
  REQUIRE(study.Run([&](int job, const PlannedEpisode& episode) {
    return episode.name == victim && ++attempts ? Bad(job, episode) : Good(job, episode);
  }));
  CHECK(attempts == 2);
  CHECK(study.records.size() == 12);
  CHECK(study.records.at(victim).status == EpisodeStatus::kFailed);
  CHECK(study.records.at(victim).attempts == 2);
  CHECK(study.records.at(victim).detail == "sim died");
  CHECK(study.progress.failed == 1);
  attempts = 0;
  REQUIRE(study.Run([&](int job, const PlannedEpisode& episode) {
    return ++attempts == 1 ? Bad(job, episode) : Good(job, episode);
  }));
  CHECK(attempts == 2);  // a second attempt that succeeds is a success
  CHECK(study.records.at(victim).status == EpisodeStatus::kComplete);
  CHECK(study.records.at(victim).attempts == 2);
}

TEST_CASE("Goals left over are a result after the second attempt", "[study]") {
  Fixture study;
  int played = 0;
  const auto play = [&](int, const PlannedEpisode&) {
    ++played;
    return EpisodeRecord{.status = EpisodeStatus::kGoalsLeft,
                         .measures = SampleMeasures(10.0, 400.0)};
  };
  for (int command = 1; command <= 2; ++command) {
    REQUIRE(study.Run(play));
    CHECK(played == 24);
  }
  CHECK(study.progress.failed == 0);
}

TEST_CASE("A record that cannot be written ends the study with the reason", "[study]") {
  Fixture study;
  int played = 0;
  const auto done = study.Run([&](int job, const PlannedEpisode& episode) {
    ++played;
    std::filesystem::remove(study.parent / "study/episodes");
    return Good(job, episode);
  });
  REQUIRE_FALSE(done);
  CHECK_THAT(done.error().text, Catch::Contains("episodes"));
  CHECK(played == 1);
  CHECK(study.records.empty());
}

}  // namespace
}  // namespace conav::study
