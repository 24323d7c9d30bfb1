#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "operator/simulated/path_planner.h"
#include "operator/simulated/snapshot_reader.h"

// Kinds of people that edit for other reasons than the paper's. Each is a row of kMechanisms: how a picture's cells are
// misplaced, which differences are noticed, what follows from an edit. Written down, with the parameters of
// deploy/config/people, before any model was measured on them.

namespace conav::operators {
namespace {

using Parameters = SnapshotReaderParameters;
using Thing = PictureSight::Thing;

constexpr double kThirdRad = 15.0 * std::numbers::pi / 180.0;  // half of the image's middle third

/// How one picture is taken: cells seem to be elsewhere, as seen from the camera.
struct Misreading {
  double scale = 1.0;
  double turn_rad = 0.0;
  int left = 0;        // cells
  double third = 0.0;  // -1 right, 0 middle, 1 left: the part that is looked at
};

Cell Seems(const PictureSight& sight, const Misreading& misreading, Cell cell) {
  const Cell camera = sight.camera;
  const double east = misreading.scale * (cell.column - camera.column);
  const double north = misreading.scale * (camera.row - cell.row);
  const double cosine = std::cos(misreading.turn_rad);
  const double sine = std::sin(misreading.turn_rad);
  const Cell left = AxisOffset(sight.heading_rad + std::numbers::pi / 2.0);
  return {camera.row - static_cast<int>(std::lround(sine * east + cosine * north)) +
              misreading.left * left.row,
          camera.column + static_cast<int>(std::lround(cosine * east - sine * north)) +
              misreading.left * left.column};
}

// How a picture is misread.

Misreading AsItIs(const Parameters&, Random&) { return {}; }

Misreading ToOneSide(const Parameters& p, Random& random) {
  if (!random.Chance(p.rate)) return {};
  return {.left = random.Chance(p.amount) ? 1 : -1};
}

Misreading OtherHeading(const Parameters& p, Random& random) {
  if (!random.Chance(p.rate)) return {};
  const double turn = random.Chance(p.amount) ? std::numbers::pi / 4.0 : std::numbers::pi / 2.0;
  return {.turn_rad = random.Chance(0.5) ? turn : -turn};
}

Misreading OtherDepth(const Parameters& p, Random& random) {
  return {.scale = std::max(0.2, p.amount + p.rate * (2.0 * random.Unit() - 1.0))};
}

Misreading OneThird(const Parameters& p, Random& random) {
  const double favourite = std::round(p.amount);
  if (random.Chance(p.rate)) return {.third = favourite};
  return {.third = static_cast<double>(random.Uniform(-1, 1))};
}

// With which probability a difference is edited.

double Always(const Parameters& p, const PictureSight&, const Thing&, const Misreading&) {
  return p.edit_probability;
}

double ByDistance(const Parameters& p, const PictureSight&, const Thing& thing, const Misreading&) {
  return p.edit_probability / (1.0 + std::exp((thing.distance - p.decay_cells) / p.amount));
}

double WhenSeenBefore(const Parameters& p, const PictureSight&, const Thing& thing,
                      const Misreading&) {
  return p.edit_probability * (thing.seen_before ? 1.0 : p.rate);
}

double InTheThird(const Parameters& p, const PictureSight&, const Thing& thing,
                  const Misreading& misreading) {
  const double third = thing.left_rad > kThirdRad ? 1.0 : thing.left_rad < -kThirdRad ? -1.0 : 0.0;
  return third == misreading.third ? p.edit_probability : 0.0;
}

/// Removes what opens a passage between two free cells, and the rest reluctantly.
double Opening(const Parameters& p, const PictureSight& sight, const Thing& thing,
               const Misreading&) {
  if (thing.wall) return p.edit_probability * p.rate;
  const auto opens = [&](Cell offset) {
    const Cell a = thing.cell + offset;
    const Cell b = thing.cell - offset;
    return sight.walls.Contains(a) && sight.walls.Contains(b) && sight.walls[a] == 0 &&
           sight.walls[b] == 0;
  };
  return opens({0, 1}) || opens({1, 0}) ? p.edit_probability : p.edit_probability * p.amount;
}

using MisreadFunction = Misreading (*)(const Parameters&, Random&);
using NoticeFunction = double (*)(const Parameters&, const PictureSight&, const Thing&,
                                  const Misreading&);

struct Mechanism {
  MisreadFunction misread = AsItIs;
  NoticeFunction notice = Always;
  bool draws_on = false;  // completes a wall beyond what is seen
  bool may_stop = false;  // after each edit, in reading order
  bool by_path = true;    // concludes from the path as from nothing else
};

/// By ReadingMechanism.
constexpr std::array<Mechanism, kReadingMechanisms.size()> kMechanisms{{
    {},  // paper: SnapshotReading's own
    {.notice = ByDistance, .by_path = false},
    {.misread = ToOneSide},
    {.misread = OtherHeading},
    {.misread = OtherDepth},
    {.notice = WhenSeenBefore},
    {.draws_on = true},
    {.misread = OneThird, .notice = InTheThird},
    {.may_stop = true},
    {.notice = Opening},
}};

/// The differences between map and picture as misread, in reading order.
std::vector<Thing> Differences(const PictureSight& sight, const Misreading& misreading) {
  std::vector<Thing> things;
  Grid<std::uint8_t> taken(sight.walls.rows(), sight.walls.columns(), 0);
  for (const Thing& seen : sight.things) {  // the path first, then walls, then what is free
    Thing thing = seen;
    if (!thing.driven) thing.cell = Seems(sight, misreading, seen.cell);
    if (!taken.Contains(thing.cell) || taken[thing.cell] != 0) continue;
    taken[thing.cell] = 1;
    if (sight.editable[thing.cell] != 0 && (sight.walls[thing.cell] != 0) != thing.wall) {
      things.push_back(thing);
    }
  }
  std::ranges::sort(things, {}, &Thing::cell);
  return things;
}

/// Draws the wall at `from` on, up to `cells` to either side along the walls next to it.
void DrawOn(const PictureSight& sight, Cell from, double cells, std::vector<CellEdit>& edits) {
  const auto is_wall = [&](Cell cell) {
    return sight.walls.Contains(cell) && sight.walls[cell] != 0;
  };
  for (const Cell along : {Cell{0, 1}, Cell{1, 0}}) {
    if (!is_wall(from + along) && !is_wall(from - along)) continue;
    for (const Cell step : {along, Cell{-along.row, -along.column}}) {
      Cell cell = from + step;
      for (int i = 0; i < cells && sight.editable.Contains(cell); ++i, cell = cell + step) {
        if (sight.editable[cell] == 0 || is_wall(cell) || sight.shown_free[cell] != 0) break;
        edits.push_back({cell, true});
      }
    }
  }
}

}  // namespace

PictureSight::PictureSight(const BeliefGrid& belief, const Snapshot& snapshot,
                           const std::set<Cell>& certain, const PictureMemory& memory)
    : walls(belief.rows(), belief.columns(), 0),
      editable(walls),
      shown_free(walls),
      camera(snapshot.cell),
      heading_rad(snapshot.heading_rad) {
  for (std::size_t i = 0; i < belief.size(); ++i) {
    const Cell cell = belief.CellAt(i);
    walls.values()[i] = IsWall(belief, cell);
    editable.values()[i] = !belief.OnBorder(cell) && !certain.contains(cell);
  }
  const auto add = [&](Cell cell, bool wall, bool driven) {
    if (!walls.Contains(cell)) return;
    if (!wall) shown_free[cell] = 1;
    const double distance = std::hypot(cell.row - camera.row, cell.column - camera.column);
    const double left =
        distance == 0.0 ? 0.0 : WrapAngle(HeadingTowards(camera, cell) - heading_rad);
    things.push_back({cell, wall, driven, memory.contains({cell, wall}), distance, left});
  };
  for (const Cell cell : snapshot.path) add(cell, false, true);
  add(snapshot.cell, false, true);
  for (const Cell cell : snapshot.visible.walls) add(cell, true, false);
  for (const Cell cell : snapshot.visible.free) add(cell, false, false);
}

std::vector<CellEdit> PictureSight::Draw(const SnapshotReaderParameters& p, Random& random) const {
  const Mechanism& mechanism = kMechanisms[static_cast<std::size_t>(p.mechanism)];
  const Misreading misreading = mechanism.misread(p, random);
  std::vector<CellEdit> edits;
  for (const Thing& thing : Differences(*this, misreading)) {
    if (static_cast<int>(edits.size()) >= p.edit_limit) break;
    const bool by_path = mechanism.by_path && thing.driven;
    if (!random.Chance(by_path ? p.path_removal_probability
                               : mechanism.notice(p, *this, thing, misreading))) {
      continue;
    }
    edits.push_back({thing.cell, thing.wall});
    if (mechanism.draws_on && thing.wall && random.Chance(p.rate)) {
      DrawOn(*this, thing.cell, p.amount, edits);
    }
    if (mechanism.may_stop && random.Chance(p.rate)) break;
  }
  if (random.Chance(p.guess_probability)) {
    const std::size_t i =
        static_cast<std::size_t>(random.Uniform(0, static_cast<std::int64_t>(walls.size()) - 1));
    if (editable.values()[i] != 0) edits.push_back({walls.CellAt(i), walls.values()[i] == 0});
  }
  return edits;
}

void Remember(const Snapshot& snapshot, PictureMemory& memory) {
  for (const Cell cell : snapshot.visible.walls) memory.insert({cell, true});
  for (const Cell cell : snapshot.visible.free) memory.insert({cell, false});
}

}  // namespace conav::operators
