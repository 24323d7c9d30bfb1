#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/grid/grid.h"
#include "common/runtime/file.h"
#include "common/runtime/random.h"

// draw_buildings FOLDER: writes the synthetic floor plans of this folder, each as a map_server pair:
// the building as it is, and the operator's outdated plan of it (docs/waterway.md).
//
// A plan is drawn on modules of 1 m. Walls are 0.3 m thick and run along the middles of modules,
// doors are 1 m wide, furniture, racks and pallets fill theirs.

namespace conav {
namespace {

enum class Module : char { kFree = ' ', kWall = '#', kDoor = 'D', kThing = 'x' };
using Modules = Grid<Module>;
using enum Module;

bool IsOpen(Module module) { return module == kFree || module == kDoor; }

struct Building {
  Modules truth;
  Modules plan;
};

void Fill(Modules& modules, int row, int column, int rows, int columns, Module value) {
  for (int r = row; r < row + rows; ++r) {
    for (int c = column; c < column + columns; ++c) modules[{r, c}] = value;
  }
}

Modules Hall(int rows, int columns) {
  Modules modules(rows, columns, kWall);
  Fill(modules, 1, 1, rows - 2, columns - 2, kFree);
  return modules;
}

bool IsConnected(const Modules& modules) {
  std::vector<Cell> queue;
  Grid<char> seen(modules.rows(), modules.columns(), 0);
  std::size_t open = 0;
  for (std::size_t i = 0; i < modules.size(); ++i) {
    if (!IsOpen(modules.values()[i])) continue;
    if (open++ == 0) queue.push_back(modules.CellAt(i));
  }
  if (open > 0) seen[queue.front()] = 1;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    for (const Cell offset : kNeighbourOffsets) {
      const Cell cell = queue[next] + offset;
      if (!modules.Contains(cell) || !IsOpen(modules[cell]) || seen[cell] != 0) continue;
      seen[cell] = 1;
      queue.push_back(cell);
    }
  }
  return queue.size() == open;
}

/// Closes the cell with `value` unless that cuts the building in two.
bool Close(Modules& modules, Cell cell, Module value) {
  if (!IsOpen(modules[cell])) return false;
  const Module before = std::exchange(modules[cell], value);
  if (IsConnected(modules)) return true;
  modules[cell] = before;
  return false;
}

Cell Draw(const Modules& modules, Random& random) {
  return {static_cast<int>(random.Uniform(1, modules.rows() - 2)),
          static_cast<int>(random.Uniform(1, modules.columns() - 2))};
}

/// `count` modules of furniture or pallets where no door is next to them.
void Furnish(Modules& modules, int count, Random& random) {
  while (count > 0) {
    const Cell cell = Draw(modules, random);
    const bool at_door = std::ranges::any_of(
        kNeighbourOffsets, [&](Cell offset) { return modules[cell + offset] == kDoor; });
    if (modules[cell] == kFree && !at_door && Close(modules, cell, kThing)) --count;
  }
}

/// Rooms of a strip between two walls, with a door each to the corridor at row `corridor_wall`, and
/// some to the next room.
void AddRooms(Modules& modules, int row, int rows, int column, int columns, int corridor_wall,
              Random& random) {
  const int end = column + columns;
  while (column < end) {
    int width = static_cast<int>(random.Uniform(4, 8));
    if (end - column - width < 5) width = end - column;
    modules[{corridor_wall, column + static_cast<int>(random.Uniform(1, width - 2))}] = kDoor;
    column += width;
    if (column < end) {
      Fill(modules, row, column, rows, 1, kWall);
      if (random.Chance(0.4)) {
        modules[{row + static_cast<int>(random.Uniform(1, rows - 2)), column}] = kDoor;
      }
      ++column;
    }
  }
}

/// 100 x 60 m: corridors 2 m wide, rooms on both sides, three corridors across.
Modules Office(Random& random) {
  constexpr int kRows = 60, kColumns = 100, kDepth = 7;
  Modules modules = Hall(kRows, kColumns);
  const int across[] = {1, 49, 97};
  for (int corridor = 9; corridor < kRows; corridor += 19) {
    for (const int wall : {corridor - 1, corridor + 2}) Fill(modules, wall, 1, 1, 98, kWall);
    if (corridor > 9) Fill(modules, corridor - 9, 1, 1, 98, kWall);
    for (const int column : {4, 52}) {
      AddRooms(modules, corridor - 1 - kDepth, kDepth, column, 44, corridor - 1, random);
      AddRooms(modules, corridor + 3, kDepth + (corridor > 40 ? 2 : 0), column, 44, corridor + 2,
               random);
    }
  }
  for (const int column : across) {
    if (column > 1) Fill(modules, 1, column - 1, kRows - 2, 1, kWall);
    if (column < 97) Fill(modules, 1, column + 2, kRows - 2, 1, kWall);
    Fill(modules, 1, column, kRows - 2, 2, kFree);
  }
  for (int corridor = 9; corridor < kRows; corridor += 19) Fill(modules, corridor, 1, 2, 98, kFree);
  return modules;
}

/// 104 x 120 m: three halls with racks, gates between them.
Modules Warehouse(Random& random) {
  constexpr int kRows = 104, kColumns = 120;
  Modules modules = Hall(kRows, kColumns);
  for (const int wall : {40, 80}) {
    Fill(modules, 1, wall, kRows - 2, 1, kWall);
    for (int gate = 0; gate < 4; ++gate) {
      const int row = 4 + 25 * gate + static_cast<int>(random.Uniform(0, 16));
      Fill(modules, row, wall, 2, 1, kDoor);
    }
  }
  for (int hall = 0; hall < 3; ++hall) {
    for (int column = 4 + 40 * hall; column + 2 < 38 + 40 * hall; column += 5) {
      int row = 4;
      while (row < kRows - 8) {
        const int length = std::min<int>(static_cast<int>(random.Uniform(8, 20)), kRows - 4 - row);
        Fill(modules, row, column, length, 2, kThing);
        row += length + 2;
      }
    }
  }
  return modules;
}

/// The plan was right once. Since then people have closed doors, made others, moved furniture and
/// put things into corridors and aisles.
Building Outdated(const Modules& built, int furniture, Random& random) {
  Building building{built, built};
  for (std::size_t i = 0; i < built.size(); ++i) {
    if (built.values()[i] != kDoor) continue;
    const Cell cell = built.CellAt(i);
    const double change = random.Unit();
    if (change < 0.25) Close(building.truth, cell, kWall);
    if (change > 0.75) Close(building.plan, cell, kWall);
  }
  Furnish(building.truth, furniture / 2, random);
  for (std::size_t i = 0; i < built.size(); ++i) {
    if (building.truth.values()[i] == kThing && built.values()[i] != kThing) {
      building.plan.values()[i] = kThing;
    }
  }
  Furnish(building.truth, furniture / 2, random);
  Furnish(building.plan, furniture / 2, random);
  return building;
}

/// Racks have gaps that the plan does not know, and the plan has some that are filled now.
void MoveRacks(Building& building, Random& random) {
  for (int bay = 0; bay < 60; ++bay) {
    Cell cell = Draw(building.truth, random);
    cell.row = std::min(cell.row, building.truth.rows() - 6);
    for (int column = cell.column - 1; column <= cell.column; ++column) {
      for (int row = cell.row; row < cell.row + 3; ++row) {
        Modules& gap = bay % 2 == 0 ? building.truth : building.plan;
        if (gap[{row, column}] == kThing) gap[{row, column}] = kFree;
      }
    }
  }
}

/// Black on white, row 0 north.
cv::Mat Paint(const Modules& modules, int side) {
  constexpr int kWhite = 254;
  cv::Mat image(modules.rows() * side, modules.columns() * side, CV_8UC1, cv::Scalar(kWhite));
  const int first = (side * 7 + 19) / 20, thick = side * 3 / 10;
  const auto bar = [&](Cell cell, int row, int column, int rows, int columns) {
    image(cv::Rect(cell.column * side + column, cell.row * side + row, columns, rows)) = 0;
  };
  for (std::size_t i = 0; i < modules.size(); ++i) {
    const Cell cell = modules.CellAt(i);
    if (modules[cell] == kThing) bar(cell, 0, 0, side, side);
    if (modules[cell] != kWall) continue;
    bar(cell, first, first, thick, thick);
    const auto reaches = [&](Cell offset) {
      const Cell next = cell + offset;
      return modules.Contains(next) && (modules[next] == kWall || modules[next] == kDoor);
    };
    if (reaches({-1, 0})) bar(cell, 0, first, first, thick);
    if (reaches({1, 0})) bar(cell, first, first, side - first, thick);
    if (reaches({0, -1})) bar(cell, first, 0, thick, first);
    if (reaches({0, 1})) bar(cell, first, first, thick, side - first);
  }
  return image;
}

/// Pixels of 1 / `side` m. False: not written.
bool Write(const std::filesystem::path& folder, const std::string& name, const Modules& modules,
           int side) {
  const auto written = WriteFile(
      folder / (name + ".yaml"),
      fmt::format("# Synthetic, written by draw_buildings.cc.\nimage: {}.png\nresolution: {}\n"
                  "origin: [0.0, 0.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
                  name, 1.0 / side));
  return written && cv::imwrite((folder / (name + ".png")).string(), Paint(modules, side),
                                {cv::IMWRITE_PNG_COMPRESSION, 9});
}

bool DrawBuildings(const std::filesystem::path& folder) {
  Random random(14);
  const Building office = Outdated(Office(random), 120, random);
  Building warehouse = Outdated(Warehouse(random), 100, random);
  MoveRacks(warehouse, random);
  return Write(folder, "office", office.truth, 20) &&
         Write(folder, "office_plan", office.plan, 20) &&
         Write(folder, "warehouse", warehouse.truth, 10) &&
         Write(folder, "warehouse_plan", warehouse.plan, 10);
}

}  // namespace
}  // namespace conav

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "draw_buildings FOLDER\n");
    return 2;
  }
  return conav::DrawBuildings(argv[1]) ? 0 : 1;
}
