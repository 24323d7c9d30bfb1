#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/random.h"
#include "common/runtime/result.h"

namespace conav {

struct MappingTourOptions {
  int headings = 8;  // camera headings, evenly spaced; 1 to 360
  /// Once the goals are done, the tour draws random cells. The weight of a cell is `background` +
  /// the number of wrong cells of the map up to `attraction_cells` away (Euclidean, between cell
  /// centres); if all weights are 0, the draw is uniform. Both are finite and not negative.
  double background = 0.5;
  double attraction_cells = 3.0;
};

/// Errors: kInvalidArgument names the option, its value and the limits.
[[nodiscard]] Result<void> CheckMappingTourOptions(const MappingTourOptions& options);

/// Where the robot stops next, and where its camera then looks.
struct MappingStop {
  Cell cell;
  double heading_rad = 0.0;
  bool operator==(const MappingStop&) const = default;
};

/// The robot's tour in the mapping task of paper Appendix A. The tour knows the true maze and the
/// person's map of it. The robot first visits all goals in random order, then random cells,
/// preferring areas where the map is wrong. At each stop it takes a picture in a random direction.
/// Seeded: equal arguments give equal stops.
class MappingTour {
 public:
  /// Visits each of `goals` once. `options` are valid (demanded).
  MappingTour(std::vector<Cell> goals, const MappingTourOptions& options, std::uint64_t seed);

  /// The next stop of a robot at `at`. Skips goals that are unreachable from there. `truth` and
  /// `belief` (P(wall)) have the same size (demanded) and contain `at`.
  MappingStop Next(const OccupancyGrid& truth, const BeliefGrid& belief, Cell at);

 private:
  Cell DrawTarget(const OccupancyGrid& truth, const BeliefGrid& belief,
                  const std::vector<Cell>& reachable, Cell at);
  double Attraction(Cell cell, const std::vector<Cell>& wrong) const;
  double DrawHeading();

  MappingTourOptions options_;
  Random random_;
  std::vector<Cell> goals_;
  std::size_t next_goal_ = 0;
};

}  // namespace conav
