#pragma once

#include <span>

#include "planner/search/search_problem.h"

namespace conav::planner {

/// What several trees of the same root have found together (root parallelisation: Chaslot, Winands
/// and van den Herik, "Parallel Monte-Carlo Tree Search", 2008): visits and returns of each root
/// action summed in the order of the trees, the most visited action chosen, counts summed, views
/// put together. A tree without actions, because its turn never came, adds nothing. No
/// expected_path and no tree. Requires a tree.
SearchResult SumOfTrees(std::span<const SearchResult> trees);

/// The first of the trees that visited root action `action` most.
std::size_t TreeWithMostVisits(std::span<const SearchResult> trees, std::size_t action);

}  // namespace conav::planner
