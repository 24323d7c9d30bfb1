#pragma once

#include "common/grid/grid.h"

namespace conav::sim {

/// Stage 4a: fills corridors that lead nowhere. Links count as neither wall nor free.
void FillDeadEnds(Grid<char>& entities);

/// Stage 4b: straightens bends in the shape of a horseshoe, short ones first. With u and v at right
/// angles and p the corner, a bend of length L = 3 and what becomes of it:
///
///     b=2    * * * * *              * * * * *
///     b=1  *           *   becomes  *         *     (p is the leftmost of b=0, a = -2 .. L+1)
///     b=0      * * *
///     b=-1     * * *
///
/// The way along b=1 moves down to b=0. Links stop a bend.
void StraightenBends(Grid<char>& entities);

}  // namespace conav::sim
