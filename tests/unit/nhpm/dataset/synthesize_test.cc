#include "nhpm/dataset/synthesize.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <set>

#include "common/grid/map_accuracy.h"
#include "common/grid/visibility.h"
#include "common/segments/segment_checks.h"
#include "sim/world/maze_presets.h"
#include "support/refusal.h"

namespace conav::nhpm {
namespace {

Synthesis Make(const SynthesisOptions& options) {
  auto synthesis = SynthesizeSegments(options);
  REQUIRE(synthesis.has_value());
  return *std::move(synthesis);
}

SynthesisOptions Few(int trajectories, std::uint64_t seed = 1) {
  return {.trajectories = trajectories, .seed = seed};
}

TEST_CASE(
    "There are exactly as many trajectories as asked for, all good enough, and progress counts "
    "them",
    "[synthesis]") {
  for (const int wanted : {1, 2, 100}) {
    SynthesisOptions options = Few(wanted);
    std::vector<int> accepted;
    int excluded = -1;
    options.progress = [&](int now_accepted, int now_excluded) {
      accepted.push_back(now_accepted);
      excluded = now_excluded;
    };
    const Synthesis synthesis = Make(options);
    CHECK(std::is_sorted(accepted.begin(), accepted.end()));
    CHECK(accepted.back() == wanted);
    CHECK(excluded == synthesis.excluded);
    CHECK(synthesis.set.trajectories.size() == static_cast<std::size_t>(wanted));
    CHECK(CheckSegments(synthesis.set).has_value());
    for (const Trajectory& trajectory : synthesis.set.trajectories) {
      CHECK(trajectory.final_mapping_accuracy > kAcceptedMappingAccuracy);
    }
  }
}

TEST_CASE("Those who map too badly are excluded and counted", "[synthesis]") {
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

TEST_CASE("Equal seeds give equal segments, whatever the number of threads", "[synthesis]") {
  SynthesisOptions options = Few(30, 9);
  const Synthesis one = Make(options);
  for (const int threads : {2, 5, 200}) {
    options.threads = threads;
    const Synthesis many = Make(options);
    CHECK(many.set == one.set);
    CHECK(many.excluded == one.excluded);
  }
  CHECK(Make(Few(30, 10)).set != one.set);
  // More trajectories begin with the same ones.
  const SegmentSet few = Make(Few(5)).set;
  SegmentSet many = Make(Few(80)).set;
  many.trajectories.resize(few.trajectories.size());
  CHECK(many == few);
}

TEST_CASE("Each trajectory has a maze of its own, a person maps three", "[synthesis]") {
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

TEST_CASE("The default people have the paper's calibration", "[synthesis]") {
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

TEST_CASE("Impossible wishes are refused by name, people who never look, too", "[synthesis]") {
  const std::pair<const char*, void (*)(SynthesisOptions&)> rows[] = {
      {"trajectories = 0", [](auto& o) { o.trajectories = 0; }},
      {"per person = 0", [](auto& o) { o.trajectories_per_person = 0; }},
      {"threads = -1", [](auto& o) { o.threads = -1; }},
      {"9x8", [](auto& o) { o.task.preset = "9x8"; }},
      {"headings = 0", [](auto& o) { o.task.tour.headings = 0; }},
      {"attraction_cells = -1", [](auto& o) { o.task.tour.attraction_cells = -1.0; }},
      {"wrong cells", [](auto& o) { o.task.corruption.wrong_share = 0.9; }},
      {"too careless",
       [](auto& o) {
         o.population.careful.lapse_probability = {1.0, 0.0};
         o.population.careless_share = 0.0;
       }},
  };
  for (const auto& [names, spoil] : rows) {
    SynthesisOptions options = Few(2);
    spoil(options);
    test::CheckRefusal(SynthesizeSegments(options), Catch::Contains(names));
  }
}

Trajectory Mapped(std::uint64_t seed, const Annotator& annotator = {.extra_pictures = 8}) {
  auto trajectory = RunMappingTask({}, annotator, seed);
  REQUIRE(trajectory.has_value());
  return *std::move(trajectory);
}

TEST_CASE(
    "A trajectory has a picture of each goal and then the extra ones, passes every check and "
    "says where it is from",
    "[synthesis]") {
  for (const int extra : {0, 1, 9}) {
    const Trajectory trajectory = Mapped(5, {.extra_pictures = extra});
    REQUIRE(trajectory.segments.size() == 4U + static_cast<unsigned>(extra));
    for (std::uint32_t i = 0; i < trajectory.segments.size(); ++i) {
      CHECK(trajectory.segments[i].step == i);
      CHECK(trajectory.segments[i].goals_reached == std::min(i + 1, 4U));
    }
    CHECK(CheckSegments({{trajectory}}));
    CHECK(trajectory.origin == SegmentOrigin::kSynthetic);
    CHECK(trajectory.world == "conav13");
    CHECK(trajectory.annotator == ToNamedValues({}));
  }
}

TEST_CASE(
    "The robot drives through free cells, one after the other, from picture to picture, and the "
    "map goes with it",
    "[synthesis]") {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Trajectory trajectory = Mapped(seed);
    const Segment* before = nullptr;
    for (const Segment& segment : trajectory.segments) {
      if (before != nullptr) {
        CHECK(segment.query.belief == before->belief_after);
        CHECK(segment.query.path.front() == before->query.cell);
      }
      before = &segment;
      const std::vector<Cell>& path = segment.query.path;
      CHECK(path.size() >= 2);
      CHECK(path.back() == segment.query.cell);
      for (std::size_t i = 0; i < path.size(); ++i) {
        CHECK((*trajectory.truth)[path[i]] == Occupancy::kFree);
        if (i > 0) CHECK(AreNeighbours(path[i - 1], path[i]));
      }
      CHECK(std::set<Cell>(path.begin(), path.end()).size() == path.size());
    }
  }
}

TEST_CASE("A picture shows the true maze through the lens of the simulated camera", "[synthesis]") {
  const Trajectory trajectory = Mapped(2);
  for (const Segment& segment : trajectory.segments) {
    const PerceptionQuery& query = segment.query;
    CHECK(query.visible ==
          CastView(*trajectory.truth, ViewThrough(CameraLens{}, query.cell, query.heading_rad, 2)));
  }
}

TEST_CASE("The map is wrong at first by the corruption, and its accuracies are what it ends with",
          "[synthesis]") {
  const Trajectory trajectory = Mapped(3);
  const BeliefGrid truth = ToBelief(*trajectory.truth);
  const BeliefGrid& before = trajectory.segments.front().query.belief;
  const BeliefGrid& after = trajectory.segments.back().belief_after;
  int wrong_before = 0;
  int wrong_after = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    wrong_before += before.values()[i] != truth.values()[i];
    wrong_after += after.values()[i] != truth.values()[i];
  }
  CHECK(wrong_before == 20);  // round(0.12 * 13 * 13)
  CHECK(trajectory.initial_cell_accuracy == Approx(1.0 - 20.0 / 121.0));
  CHECK(trajectory.final_cell_accuracy == Approx(1.0 - wrong_after / 121.0));
  CHECK(trajectory.final_mapping_accuracy == Approx(std::max(0.0, (20.0 - wrong_after) / 20.0)));
}

TEST_CASE("The same maze mapped by another person begins the same", "[synthesis]") {
  const Trajectory slept = Mapped(7, {.reader = {.lapse_probability = 1.0}});
  CHECK(slept.truth == Mapped(7).truth);
  CHECK(slept.segments.front().query == Mapped(7).segments.front().query);
  for (const Segment& segment : slept.segments) CHECK(EditCount(segment) == 0);
  CHECK(slept.final_mapping_accuracy == 0.0);
}

TEST_CASE("Every maze preset can be mapped", "[synthesis]") {
  for (const sim::MazePreset& preset : sim::MazePresets()) {
    CAPTURE(preset.name);
    const auto trajectory = RunMappingTask({.preset = preset.name}, {}, 1);
    REQUIRE(trajectory.has_value());
    CHECK(trajectory->truth->rows() == preset.options.height);
    CHECK(trajectory->segments.back().goals_reached == static_cast<unsigned>(preset.goals));
  }
}

}  // namespace
}  // namespace conav::nhpm
