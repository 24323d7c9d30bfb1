#include "sim/world/map_file.h"

#include <fmt/format.h>

#include <cmath>

#include "sim/world/map_image.h"
#include "sim/world/random_maze.h"

namespace conav::sim {
namespace {

struct LoadedMap {
  OccupancyGrid cells;
  MapHeader header;
};

/// Pixels to cells: how many pixels each cell has, and how many of these are not free.
OccupancyGrid Resample(const OccupancyGrid& pixels, int rows, int columns, double cells_per_pixel,
                       double occupied_share) {
  Grid<int> count(rows, columns, 0);
  Grid<int> not_free(rows, columns, 0);
  const auto cell_of = [&](int pixel, int cells) {
    return std::min(cells - 1, static_cast<int>(std::floor((pixel + 0.5) * cells_per_pixel)));
  };
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Cell pixel = pixels.CellAt(i);
    const Cell cell{cell_of(pixel.row, rows), cell_of(pixel.column, columns)};
    ++count[cell];
    not_free[cell] += pixels.values()[i] == Occupancy::kFree ? 0 : 1;
  }
  OccupancyGrid cells(rows, columns, Occupancy::kFree);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool occupied = not_free.values()[i] > occupied_share * count.values()[i];
    if (occupied || count.values()[i] == 0 || cells.OnBorder(cells.CellAt(i))) {
      cells.values()[i] = Occupancy::kOccupied;
    }
  }
  return cells;
}

Result<LoadedMap> Load(const std::filesystem::path& file, const MapFileOptions& options) {
  Result<MapHeader> header = ReadMapHeader(file);
  if (!header) return tl::unexpected(header.error());
  const double resolution_m = header->resolution_m;
  if (options.cell_size_m < resolution_m) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("{}: cell_size_m {} is smaller than the map's resolution {}",
                            file.string(), options.cell_size_m, resolution_m));
  }
  const Result<OccupancyGrid> pixels = ReadMapImage(*header);
  if (!pixels) return tl::unexpected(pixels.error());
  const double cells_per_pixel = resolution_m / options.cell_size_m;
  // A sliver of less than a thousandth of a cell is a rounding error, not a row.
  const auto cells_of = [&](int count) {
    return static_cast<int>(std::ceil(count * cells_per_pixel - 1e-3));
  };
  const int rows = cells_of(pixels->rows());
  const int columns = cells_of(pixels->columns());
  if (rows < 3 || columns < 3 || rows > kMaxMazeSize || columns > kMaxMazeSize) {
    return Fail(ErrorCode::kOutOfRange,
                fmt::format("{}: {} x {} pixels of {} m make {} x {} cells of {} m: not in [3, {}]",
                            file.string(), pixels->rows(), pixels->columns(), resolution_m, rows,
                            columns, options.cell_size_m, kMaxMazeSize));
  }
  return LoadedMap{Resample(*pixels, rows, columns, cells_per_pixel, options.occupied_share),
                   *std::move(header)};
}

bool SameOrigin(const MapHeader& a, const MapHeader& b, double tolerance_m) {
  return std::abs(a.origin[0] - b.origin[0]) <= tolerance_m &&
         std::abs(a.origin[1] - b.origin[1]) <= tolerance_m;
}

}  // namespace

Result<OccupancyGrid> LoadMapFile(const std::filesystem::path& file,
                                  const MapFileOptions& options) {
  return Load(file, options).map([](LoadedMap&& map) { return std::move(map.cells); });
}

Result<MapPair> LoadMapPair(const std::filesystem::path& truth, const std::filesystem::path& plan,
                            const MapFileOptions& options) {
  Result<LoadedMap> truth_map = Load(truth, options);
  if (!truth_map) return tl::unexpected(truth_map.error());
  Result<LoadedMap> plan_map = Load(plan, options);
  if (!plan_map) return tl::unexpected(plan_map.error());
  const OccupancyGrid& a = truth_map->cells;
  const OccupancyGrid& b = plan_map->cells;
  if (a.rows() != b.rows() || a.columns() != b.columns()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} has {} x {} cells, {} has {} x {}: must be the same", plan.string(),
                            b.rows(), b.columns(), truth.string(), a.rows(), a.columns()));
  }
  if (!SameOrigin(truth_map->header, plan_map->header, options.cell_size_m / 10.0)) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} has its origin at ({}, {}), {} at ({}, {}): must be the same",
                    plan.string(), plan_map->header.origin[0], plan_map->header.origin[1],
                    truth.string(), truth_map->header.origin[0], truth_map->header.origin[1]));
  }
  return MapPair{std::move(truth_map->cells), std::move(plan_map->cells)};
}

}  // namespace conav::sim
