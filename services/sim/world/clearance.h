#pragma once

#include <cstdint>
#include <vector>

#include "common/grid/grid.h"

/// Where a robot fits that is a disc on the floor, and its ways there. Whole cells and integers, so
/// that worlds drawn with these are the same on every machine.
namespace conav::sim {

/// 1 where a disc of that radius (in cells) around the cell's middle touches no cell that is not
/// free, else 0. The map's edge counts as an obstacle. Steps between 4-neighbours that are 1 keep
/// the distance all the way.
Grid<std::uint8_t> RoomFor(const OccupancyGrid& map, double radius_cells);

/// Number of steps between 4-neighbours from `from` over cells of `room`; -1 where no way leads.
Grid<int> StepsFrom(const Grid<std::uint8_t>& room, Cell from);

/// A shortest way from `from` to where `steps` began, both included; empty if there is none.
std::vector<Cell> WayBack(const Grid<int>& steps, Cell from);

/// The largest connected area of `room`, row-major; of several equally large ones the northernmost.
std::vector<Cell> LargestArea(const Grid<std::uint8_t>& room);

/// The largest radius, in cells (multiples of 0.25, at most 64), with which a robot gets from `from`
/// to `to`; below 0 if no robot does.
double WidestRadius(const OccupancyGrid& map, Cell from, Cell to);
/// The same for a robot that gets around on at least half of the map's largest free area.
double WidestRadius(const OccupancyGrid& map);

}  // namespace conav::sim
