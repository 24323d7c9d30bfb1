#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "common/msg/robot.h"
#include "common/msg/supervision.h"
#include "common/runtime/random.h"

namespace conav {
class ConfigReader;
}

namespace conav::operators {

/// Kinds of people, by why they edit: SnapshotReaderParameters::mechanism.
enum class ReadingMechanism : std::uint8_t {
  kPaper,
  kDistance,
  kLateral,
  kHeading,
  kDepth,
  kMemory,
  kSketch,
  kRegion,
  kListing,
  kOpening,
};

inline constexpr std::array kReadingMechanisms{
    ReadingMechanism::kPaper,   ReadingMechanism::kDistance, ReadingMechanism::kLateral,
    ReadingMechanism::kHeading, ReadingMechanism::kDepth,    ReadingMechanism::kMemory,
    ReadingMechanism::kSketch,  ReadingMechanism::kRegion,   ReadingMechanism::kListing,
    ReadingMechanism::kOpening};

constexpr std::string_view Name(ReadingMechanism mechanism) {
  constexpr std::string_view kNames[] = {"paper",  "distance", "lateral", "heading", "depth",
                                         "memory", "sketch",   "region",  "listing", "opening"};
  return kNames[static_cast<std::size_t>(mechanism)];
}

/// How carefully the synthetic person reads a picture. The defaults are the careful one: about one
/// edit for each picture that shows errors of the map, most of them right, so that the map becomes
/// better on balance. Distances are Euclidean between cell centres, in cells, from the camera.
///
/// On a raster (IsRaster) the person decides about patches, so that errors are correlated over an
/// area as people's are: a patch is missed, misplaced or guessed as a whole. A patch is a connected
/// piece (4-neighbours) of cells of one kind (driven through, shown free, shown as wall) within one
/// square of the map, EditSide() cells a side; its distance and angle are those of its cell nearest
/// to its centroid. Where the parameters say cells or edits they count patches; their distances in
/// cells mean so many times 2 m. In a maze a patch is a cell, and none of this changes a bit.
/// The rules and their two lengths were fixed before anything was measured with them.
struct SnapshotReaderParameters {
  /// A discrepancy at distance d is edited with probability edit_probability * exp(-d / decay).
  double edit_probability = 0.95;
  double decay_cells = 12.0;
  /// A wall of the map on a cell that the robot drove through is removed with this probability.
  double path_removal_probability = 0.97;
  /// A missing wall at `far_cells` or more, within `centre_deg` of the view axis, that continues a
  /// wall of the map, is added with at least this probability.
  double far_centre_probability = 0.8;
  double far_cells = 3.0;
  double centre_deg = 10.0;
  /// A missing wall nearer than far_cells and more than `lateral_deg` off the axis is overlooked
  /// more often: its probability is multiplied by this.
  double lateral_factor = 0.75;
  double lateral_deg = 25.0;
  /// A wall up to `near_cells` away that is added lands one cell off along the view axis.
  double misplacement_probability = 0.05;
  double near_cells = 2.0;
  /// The picture is not looked at.
  double lapse_probability = 0.03;
  /// A cell next to those that the picture shows is flipped for no reason.
  double guess_probability = 0.02;
  /// Nearest first, a person stops after so many edits to one picture.
  int edit_limit = 6;
  /// Why this person edits: "paper" is described above. The others use
  /// edit_probability, path_removal_probability, lapse, guess (any cell), edit_limit, and two values of
  /// their own:
  ///
  ///   distance  noticed with edit_probability / (1 + exp((d - decay_cells) / amount)), the path too
  ///   lateral   in `rate` of the pictures all is one cell to the side, to the left in `amount` of them
  ///   heading   `rate` of the pictures are taken for ones turned by 45 degrees (`amount` of them) or 90
  ///   depth     distances seem `amount` times as long, +- `rate`, drawn for each picture
  ///   memory    edits what an earlier picture showed, too; at first sight `rate` times as often
  ///   sketch    `rate` of the added walls are drawn on, up to `amount` cells to either side
  ///   region    looks at one third of the image: -1 right, 0 middle, 1 left (`amount`, rounded), or
  ///             with 1 - rate at any
  ///   listing   edits row by row from the map's top, and stops after each edit with `rate`
  ///   opening   removes walls that open a passage; others `amount` times as often, and adds walls
  ///             `rate` times as often
  ///
  /// They decide about cells, on rasters too.
  ReadingMechanism mechanism = ReadingMechanism::kPaper;
  double rate = 0.0;
  double amount = 0.0;

  void Visit(ConfigReader& reader);
};

/// What earlier pictures showed: a cell, and whether as a wall.
using PictureMemory = std::set<std::pair<Cell, bool>>;
void Remember(const Snapshot& snapshot, PictureMemory& memory);

/// A picture and the map, as people of another mechanism than "paper" look at them
/// (reading_mechanisms.cc).
struct PictureSight {
  struct Thing {
    Cell cell;
    bool wall = false;
    bool driven = false;
    bool seen_before = false;
    double distance = 0.0;  // cells
    double left_rad = 0.0;  // off the view axis
  };

  PictureSight(const BeliefGrid& belief, const Snapshot& snapshot, const std::set<Cell>& certain,
               const PictureMemory& memory);
  /// The edits of one look, in the order in which they are made.
  std::vector<CellEdit> Draw(const SnapshotReaderParameters& parameters, Random& random) const;

  Grid<std::uint8_t> walls;  // of the map
  Grid<std::uint8_t> editable;
  Grid<std::uint8_t> shown_free;
  Cell camera;
  double heading_rad;
  std::vector<Thing> things;
};

/// Which of `goals`, objects that only a person recognises, are noticed in a picture: like anything
/// else less often the farther they are.
std::vector<Cell> NoticedGoals(const SnapshotReaderParameters& parameters, const Snapshot& snapshot,
                               const std::vector<Cell>& goals, Random& random);

/// A request may carry so many.
inline constexpr std::size_t kMostEditedCells = 65536;

/// The neighbouring cell that `heading_rad` points to, as an offset; diagonals included.
Cell AxisOffset(double heading_rad);

/// What a synthetic person may do about one picture and their map: worked out once, drawn as
/// often as wanted.
/// Threads: const and safe to call concurrently, with a Random each.
class SnapshotReading {
 public:
  /// Cells of the picture outside of the belief are ignored; `certain` cells are left as they are.
  SnapshotReading(const SnapshotReaderParameters& parameters, const BeliefGrid& belief,
                  const Snapshot& snapshot, const std::set<Cell>& certain,
                  const PictureMemory& memory = {});

  /// The edits of one look: in row-major order, each cell once, each a change of the belief; at most
  /// kMostEditedCells.
  std::vector<CellEdit> Draw(Random& random) const;

  /// Every cell that a draw may edit, row-major, each once.
  std::vector<Cell> PossibleCells() const;

 private:
  struct Look;
  /// Cells that become wall, or free, together.
  struct Patch {
    bool wall = false;
    std::vector<Cell> cells;
  };
  /// One difference between picture and map.
  struct Discrepancy {
    Patch patch;
    Cell centre;
    double distance = 0.0;
    double probability = 0.0;
    /// Where a near wall may be misplaced to, cell by cell; empty: it may not.
    std::vector<Cell> beyond;
    std::vector<Cell> before;
  };

  double EditProbability(double distance) const;
  double AddProbability(const Look& look, const Discrepancy& discrepancy) const;
  Discrepancy Weigh(const Look& look, Patch patch) const;
  const std::vector<Cell>& DrawPlaces(const Discrepancy& discrepancy, Random& random) const;

  SnapshotReaderParameters parameters_;
  std::optional<PictureSight> sight_;       // of another mechanism than "paper"
  std::vector<Discrepancy> discrepancies_;  // nearest first
  std::vector<Patch> guesses_;              // next to what is shown, row-major
};

/// Looks at a picture as people were seen to do, and says which cells of the map they would change:
/// a SYNTHETIC annotator, not a model fitted to data.
///
/// It compares the cells that the picture shows, and the cells that the robot drove through, with
/// the belief. Never edits the border, and never puts a wall where a robot has been.
/// Source:  paper section 6.1 (qualitative), 6.3.
/// Seeded:  equal seeds and equal sequences of pictures and beliefs give equal edits.
class SnapshotReader {
 public:
  SnapshotReader(const SnapshotReaderParameters& parameters, std::uint64_t seed);

  /// Edits in row-major order, each cell once, each a change of `belief`. Cells of the picture
  /// outside of the belief are ignored. `certain` cells are left as they are.
  std::vector<CellEdit> Read(const BeliefGrid& belief, const Snapshot& snapshot,
                             const std::set<Cell>& certain);

  /// One draw of this reader's random numbers: is a picture of a stream looked at?
  bool Glances(double rate) { return random_.Chance(rate); }

 private:
  SnapshotReaderParameters parameters_;
  Random random_;
  PictureMemory memory_;
};

}  // namespace conav::operators
