#pragma once

#include <cstdint>
#include <span>

#include "sim/physics/world_model.h"

namespace conav::sim {

/// Base colours of the wall textures (mean RGB of MemoryMaze's eight), of the two floors, and of
/// water and land.
inline constexpr int kWallTextureCount = 8;
inline constexpr Rgb kWallColors[kWallTextureCount] = {
    {32, 116, 177}, {169, 65, 103},  {166, 197, 156}, {85, 120, 75},
    {68, 80, 176},  {213, 123, 104}, {143, 32, 26},   {196, 169, 38}};
inline constexpr int kMazeFloorTextureCount = 2;  // corridor, room
inline constexpr int kWaterTexture = 2;
inline constexpr int kLandTexture = 3;
inline constexpr int kFloorTextureCount = 4;
inline constexpr Rgb kFloorColors[kFloorTextureCount] = {
    {54, 89, 109}, {111, 148, 170}, {52, 118, 178}, {104, 132, 72}};

inline constexpr int kTextureSize = 256;  // pixels per side; one texture covers one cell

/// Draw one square texture: `rgb` has kTextureSize^2 * 3 values, row 0 the upper edge of a wall.
/// Wall: panels with thin dark traces, a dark strip below, a light one above, and dark edges left
/// and right, so that a person can count the cells. Floor: hexagon tiles, seven to a cell, a few
/// darker. `variant` changes the traces and the choice of dark tiles.
void DrawWallTexture(Rgb base, int variant, std::span<std::uint8_t> rgb);
void DrawFloorTexture(Rgb base, int variant, std::span<std::uint8_t> rgb);

}  // namespace conav::sim
