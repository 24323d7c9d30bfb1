#pragma once

#include "common/plot/map_panel.h"
#include "planner/search/search_problem.h"

// One user: figure 7; tested alone, with the graph that it draws.

namespace conav::planner {

/// Draws a navigation graph: the cells of each vertex in a faint colour, edges as lines, dashed where
/// they may fail, vertices as dots. What no vertex stands for is left as it is.
void DrawRegions(const NavigationGraph& graph, PixelPosition corner, double cell_pixels,
                 SvgCanvas& canvas);

}  // namespace conav::planner
