#include "nhpm/dataset/synthesize.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <set>

#include "common/segments/segment_checks.h"
#include "operator/simulated/path_planner.h"

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
    const auto synthesis = SynthesizeSegments(options);
    REQUIRE_FALSE(synthesis.has_value());
    CHECK_THAT(synthesis.error().text, Catch::Contains(names));
  }
}

// The error patterns of paper section 6.1 and figure 3, measured in generated segments.

using operators::IsWall;

SegmentSet SegmentsBy(const AnnotatorPopulation& population) {
  SynthesisOptions options = Few(250, 2);
  options.population = population;
  return Make(options).set;
}

const SegmentSet& DefaultSet() {
  static const SegmentSet set = SegmentsBy({});
  return set;
}

/// A cell where picture or path contradict the map, and what became of it.
struct Discrepancy {
  const Segment* segment = nullptr;
  Cell cell;
  bool wall = false;     // in truth
  bool on_path = false;  // driven through
  bool edited = false;

  double Distance() const {
    const Cell way = cell - segment->query.cell;
    return std::hypot(way.row, way.column);
  }
  double DegreesOffAxis() const {
    const double heading = HeadingTowards(segment->query.cell, cell);
    return std::abs(WrapAngle(heading - segment->query.heading_rad)) * 57.29577951308232;
  }
};

bool Edited(const Segment& segment, Cell cell) {
  return segment.belief_after.Contains(cell) &&
         segment.belief_after[cell] != segment.query.belief[cell];
}

std::vector<Discrepancy> DiscrepanciesOf(const Segment& segment) {
  const PerceptionQuery& query = segment.query;
  const std::set<Cell> path(query.path.begin(), query.path.end());
  std::set<Cell> free(query.visible.free.begin(), query.visible.free.end());
  free.insert(path.begin(), path.end());
  std::vector<Discrepancy> found;
  for (const Cell cell : free) {
    if (!IsWall(query.belief, cell)) continue;
    found.push_back({&segment, cell, false, path.contains(cell), Edited(segment, cell)});
  }
  for (const Cell cell : query.visible.walls) {
    if (IsWall(query.belief, cell)) continue;
    found.push_back({&segment, cell, true, false, Edited(segment, cell)});
  }
  return found;
}

std::vector<Discrepancy> DiscrepanciesOf(const SegmentSet& set) {
  std::vector<Discrepancy> all;
  for (const Segment* segment : AllSegments(set))
    std::ranges::move(DiscrepanciesOf(*segment), std::back_inserter(all));
  return all;
}

/// How many discrepancies of this kind there are in a set, and the share of them that was edited.
struct Rate {
  int count = 0;
  int edited = 0;
  double share() const { return static_cast<double>(edited) / count; }
};

Rate RateOf(const SegmentSet& set, const std::function<bool(const Discrepancy&)>& chosen) {
  Rate rate;
  for (const Discrepancy& one : DiscrepanciesOf(set)) {
    if (!chosen(one)) continue;
    ++rate.count;
    rate.edited += one.edited;
  }
  REQUIRE(rate.count >= 40);
  return rate;
}

/// Of the missing walls up to `kNear` away that the person left out, the share that has a new wall
/// `offset(heading)` next to it where the picture and the path show none.
double MisplacedShare(const SegmentSet& set, const std::function<Cell(double)>& offset) {
  constexpr double kNear = 4.0;
  int near = 0;
  int misplaced = 0;
  for (const Discrepancy& missing : DiscrepanciesOf(set)) {
    if (!missing.wall || missing.Distance() > kNear) continue;
    ++near;
    if (missing.edited) continue;
    const Segment& segment = *missing.segment;
    const Cell step = offset(segment.query.heading_rad);
    const auto added = [&](Cell cell) {
      return Edited(segment, cell) && IsWall(segment.belief_after, cell) &&
             !std::ranges::binary_search(segment.query.visible.walls, cell);
    };
    misplaced += added(missing.cell + step) || added(missing.cell - step);
  }
  REQUIRE(near >= 100);
  return static_cast<double>(misplaced) / near;
}

Cell Along(double heading_rad) {
  return {-static_cast<int>(std::lround(std::sin(heading_rad))),
          static_cast<int>(std::lround(std::cos(heading_rad)))};
}
Cell Across(double heading_rad) { return Along(heading_rad + 1.5707963267948966); }

TEST_CASE("The share of differences that people edit falls with distance", "[synthesis]") {
  const auto between = [](double low, double high) {
    return RateOf(DefaultSet(), [=](const Discrepancy& one) {
      return !one.wall && !one.on_path && one.Distance() > low && one.Distance() <= high;
    });
  };
  const double near = between(0.0, 2.0).share();
  const double middle = between(2.0, 4.0).share();
  const double far = between(4.0, 12.0).share();
  CAPTURE(near, middle, far);
  CHECK(near > middle);
  CHECK(middle > far + 0.05);
}

TEST_CASE("The robot's path opens walls, near or far", "[synthesis]") {
  const auto far_walls = [](bool on_path) {
    return RateOf(DefaultSet(), [=](const Discrepancy& one) {
      return !one.wall && one.on_path == on_path && one.Distance() > 4.0;
    });
  };
  CAPTURE(far_walls(true).share(), far_walls(false).share());
  CHECK(far_walls(true).share() > 0.85);
  CHECK(far_walls(true).share() > far_walls(false).share() + 0.25);
}

TEST_CASE("Near walls land one cell off along the view, hardly ever across it", "[synthesis]") {
  const double along = MisplacedShare(DefaultSet(), Along);
  const double across = MisplacedShare(DefaultSet(), Across);
  CAPTURE(along, across);
  CHECK(along > 0.1);
  CHECK(along < 0.4);
  CHECK(across < 0.05);
}

TEST_CASE(
    "A far wall at the image centre that continues one of the map is preferred to near lateral",
    "[synthesis]") {
  const auto continues = [](const Discrepancy& one) {
    const BeliefGrid& map = one.segment->query.belief;
    return std::any_of(kNeighbourOffsets.begin(), kNeighbourOffsets.end(),
                       [&](Cell offset) { return IsWall(map, one.cell + offset); });
  };
  const Rate far_centre = RateOf(DefaultSet(), [&](const Discrepancy& one) {
    return one.wall && one.Distance() > 4.5 && one.DegreesOffAxis() <= 10.0 && continues(one);
  });
  const Rate near_lateral = RateOf(DefaultSet(), [](const Discrepancy& one) {
    return one.wall && one.Distance() < 3.0 && one.DegreesOffAxis() > 25.0;
  });
  CAPTURE(far_centre.count, far_centre.share(), near_lateral.count, near_lateral.share());
  CHECK(far_centre.share() > near_lateral.share() + 0.25);
}

TEST_CASE("Lapses leave pictures without any edit, guesses edit without any difference",
          "[synthesis]") {
  const auto edited_without_reason = [](const SegmentSet& set) {
    int guesses = 0;
    int snapshots = 0;
    for (const Segment* segment : AllSegments(set)) {
      if (!DiscrepanciesOf(*segment).empty()) continue;
      ++snapshots;
      guesses += EditCount(*segment) > 0;
    }
    REQUIRE(snapshots > 500);
    return static_cast<double>(guesses) / snapshots;
  };
  AnnotatorPopulation guessing;
  guessing.careful.guess_probability = {0.2, 0.0};
  guessing.careful.lapse_probability = {0.0, 0.0};
  guessing.careless_share = 0.0;
  CHECK(edited_without_reason(SegmentsBy(guessing)) == Approx(0.2).margin(0.04));
  CHECK(edited_without_reason(DefaultSet()) == Approx(0.03).margin(0.015));

  AnnotatorPopulation drowsy;
  drowsy.careful.lapse_probability = {0.2, 0.0};
  drowsy.careless_share = 0.0;
  const auto on_path = [](const Discrepancy& one) { return one.on_path; };
  CHECK(RateOf(SegmentsBy(drowsy), on_path).share() == Approx(0.8 * 0.96).margin(0.05));
}

TEST_CASE("Two people with other habits leave other traces", "[synthesis]") {
  AnnotatorPopulation exact;
  exact.careless_share = 0.0;
  exact.careful.misplacement_probability = {0.05, 0.0};
  exact.careful.lateral_factor = {1.0, 0.0};
  AnnotatorPopulation inexact = exact;
  inexact.careful.misplacement_probability = {0.8, 0.0};
  inexact.careful.lateral_factor = {0.3, 0.0};
  const SegmentSet one = SegmentsBy(exact);
  const SegmentSet other = SegmentsBy(inexact);
  CHECK(MisplacedShare(other, Along) > MisplacedShare(one, Along) + 0.1);
  const auto lateral = [](const Discrepancy& found) {
    return found.wall && found.Distance() < 3.0 && found.DegreesOffAxis() > 25.0;
  };
  CHECK(RateOf(one, lateral).share() > RateOf(other, lateral).share() + 0.3);
}

TEST_CASE("Nobody edits the border or walls the robot in", "[synthesis]") {
  for (const Segment* segment : AllSegments(DefaultSet())) {
    const BeliefGrid& after = segment->belief_after;
    for (const Cell cell : segment->query.path) {
      CHECK_FALSE((Edited(*segment, cell) && IsWall(after, cell)));
    }
    for (std::size_t i = 0; i < after.size(); ++i) {
      const Cell cell = after.CellAt(i);
      if (after.OnBorder(cell)) CHECK_FALSE(Edited(*segment, cell));
    }
  }
}

}  // namespace
}  // namespace conav::nhpm
