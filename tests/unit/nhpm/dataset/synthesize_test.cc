#include "nhpm/dataset/synthesize.h"

#include <catch2/catch.hpp>
#include <set>

#include "common/segments/segment_checks.h"

namespace conav::nhpm {
namespace {

Synthesis Make(const SynthesisOptions& options) {
  auto synthesis = SynthesizeSegments(options);
  REQUIRE(synthesis.has_value());
  return *std::move(synthesis);
}

SynthesisOptions Few(int trajectories, std::uint64_t seed = 1) {
  SynthesisOptions options;
  options.trajectories = trajectories;
  options.seed = seed;
  return options;
}

TEST_CASE("There are exactly as many trajectories as asked for, all good enough",
          "[nhpm][synthesis]") {
  for (const int wanted : {1, 2, 100}) {
    const Synthesis synthesis = Make(Few(wanted));
    CHECK(synthesis.set.trajectories.size() == static_cast<std::size_t>(wanted));
    CHECK(CheckSegments(synthesis.set).has_value());
    for (const Trajectory& trajectory : synthesis.set.trajectories) {
      CHECK(trajectory.final_mapping_accuracy > kAcceptedMappingAccuracy);
    }
  }
}

TEST_CASE("Those who map too badly are excluded and counted", "[nhpm][synthesis]") {
  SynthesisOptions options = Few(60);
  options.population.careless_share = 0.0;
  const int with_careful = Make(options).excluded;
  options.population.careless_share = 0.6;
  const Synthesis mixed = Make(options);
  CHECK(mixed.excluded > with_careful + 30);
  // The sessions are numbered with the excluded ones.
  CHECK(mixed.set.trajectories.back().session ==
        fmt::format("1-{:05}", mixed.set.trajectories.size() + mixed.excluded));
}

TEST_CASE("Equal seeds give equal segments, whatever the number of threads", "[nhpm][synthesis]") {
  SynthesisOptions options = Few(30, 9);
  const Synthesis one = Make(options);
  for (const int threads : {2, 5, 200}) {
    options.threads = threads;
    const Synthesis many = Make(options);
    CHECK(many.set == one.set);
    CHECK(many.excluded == one.excluded);
  }
  CHECK(Make(Few(30, 10)).set != one.set);
}

TEST_CASE("More trajectories begin with the same ones", "[nhpm][synthesis]") {
  const SegmentSet few = Make(Few(5)).set;
  SegmentSet many = Make(Few(80)).set;
  many.trajectories.resize(few.trajectories.size());
  CHECK(many == few);
}

TEST_CASE("Each trajectory has a maze of its own, a person maps three", "[nhpm][synthesis]") {
  SynthesisOptions options = Few(60);
  options.population.careless_share = 0.0;
  std::set<std::uint64_t> worlds;
  std::map<std::string, std::set<std::map<std::string, double>>> people;
  for (const Trajectory& trajectory : Make(options).set.trajectories) {
    worlds.insert(trajectory.world_seed);
    people[trajectory.participant].insert(trajectory.annotator);
  }
  CHECK(worlds.size() == 60);
  CHECK(people.size() >= 20);
  CHECK(people.size() < 40);
  std::set<std::map<std::string, double>> all;
  for (const auto& [name, parameters] : people) {
    CAPTURE(name);
    CHECK(parameters.size() == 1);
    all.insert(parameters.begin(), parameters.end());
  }
  CHECK(all.size() == people.size());

  options.trajectories_per_person = 1000;
  const auto one_person = Make(options).set.trajectories;
  CHECK(one_person.front().participant == one_person.back().participant);
}

TEST_CASE("The default people have the paper's calibration", "[nhpm][synthesis]") {
  const Synthesis synthesis = Make(Few(150, 4));
  double segments = 0;
  double edits = 0;
  for (const Trajectory& trajectory : synthesis.set.trajectories) {
    segments += static_cast<double>(trajectory.segments.size());
    CHECK(trajectory.segments.size() >= 4);
    for (const Segment& segment : trajectory.segments) edits += EditCount(segment);
  }
  CHECK(segments / 150 == Approx(14.5).margin(1.0));    // 1642 segments of 113 trajectories
  CHECK(edits / segments == Approx(1.1).margin(0.25));  // "around 1"
  CHECK(synthesis.excluded > 15);                       // milder than the paper's 254 of 367
  CHECK(synthesis.excluded < 150);
}

TEST_CASE("People who never look are refused instead of waited for", "[nhpm][synthesis]") {
  SynthesisOptions options = Few(1);
  options.population.careful.lapse_probability = {1.0, 0.0};
  options.population.careless_share = 0.0;
  const auto synthesis = SynthesizeSegments(options);
  REQUIRE_FALSE(synthesis.has_value());
  CHECK(synthesis.error().code == ErrorCode::kOutOfRange);
  CHECK_THAT(synthesis.error().text, Catch::Matchers::Contains("too careless"));
}

TEST_CASE("Impossible wishes are refused by name", "[nhpm][synthesis]") {
  const auto refusal = [](auto&& spoil) {
    SynthesisOptions options = Few(2);
    spoil(options);
    const auto synthesis = SynthesizeSegments(options);
    REQUIRE_FALSE(synthesis.has_value());
    return synthesis.error().text;
  };
  using Catch::Matchers::Contains;
  CHECK_THAT(refusal([](auto& o) { o.trajectories = 0; }), Contains("trajectories = 0"));
  CHECK_THAT(refusal([](auto& o) { o.trajectories_per_person = 0; }), Contains("per person = 0"));
  CHECK_THAT(refusal([](auto& o) { o.threads = -1; }), Contains("threads = -1"));
  CHECK_THAT(refusal([](auto& o) { o.task.preset = "9x8"; }), Contains("9x8"));
  CHECK_THAT(refusal([](auto& o) { o.task.corruption.wrong_share = 0.9; }),
             Contains("wrong cells"));
}

TEST_CASE("Progress counts up to what was asked for", "[nhpm][synthesis]") {
  SynthesisOptions options = Few(100);
  std::vector<int> accepted;
  int excluded = -1;
  options.progress = [&](int now_accepted, int now_excluded) {
    accepted.push_back(now_accepted);
    excluded = now_excluded;
  };
  const Synthesis synthesis = Make(options);
  CHECK(accepted.size() >= 2);
  CHECK(std::is_sorted(accepted.begin(), accepted.end()));
  CHECK(accepted.back() == 100);
  CHECK(excluded == synthesis.excluded);
}

}  // namespace
}  // namespace conav::nhpm
