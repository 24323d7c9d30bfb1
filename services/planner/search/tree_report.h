#pragma once

#include <optional>
#include <span>
#include <vector>

#include "planner/search/search_options.h"
#include "planner/search/search_problem.h"
#include "planner/search/search_tree.h"
#include "planner/search/view_information.h"

// What a decision says of itself. The algorithm decides without it.

namespace conav::planner {

/// The root's actions, the chosen one, the counts, and with SearchDetail::kTree the most visited
/// nodes and the views asked about. `path` is the path at the root. Leaves out the iterations.
SearchResult ReportTree(const SearchTree& tree, const SearchProblem& problem,
                        OfferedActions& offered, const ViewInformation& information,
                        const PathState& path, SearchDetail detail);

/// The cells along the most visited actions, as SearchResult::expected_path; from `action` of the
/// root on if given.
std::vector<Cell> ExpectedPath(const SearchTree& tree, const NavigationGraph& graph,
                               std::optional<int> action = std::nullopt);

/// The `limit` most visited nodes of `tree` for a report, the root first and each parent before its
/// children; ties by age. A node is never visited more than its parent, so that none loses its own.
std::vector<ReportedNode> MostVisitedNodes(const SearchTree& tree, const NavigationGraph& graph,
                                           std::size_t limit);

/// The sum of several trees of the same root (root parallelisation: Chaslot, Winands and van den
/// Herik, "Parallel Monte-Carlo Tree Search", 2008): adds up the visits and returns of each root
/// action in the order of the trees, chooses the most visited action, adds up the counts, merges the
/// views. A tree without actions, because its turn never came, adds nothing. No expected_path and no
/// tree. Requires a tree.
SearchResult SumOfTrees(std::span<const SearchResult> trees);

/// The first of the trees that visited root action `action` most.
std::size_t TreeWithMostVisits(std::span<const SearchResult> trees, std::size_t action);

}  // namespace conav::planner
