#pragma once

#include <vector>

#include "common/protocol/search_report.h"
#include "planner/search/navigation_graph.h"
#include "planner/search/search_tree.h"

namespace conav::planner {

/// The `limit` most visited nodes of `tree` for a report, the root first and each parent before its
/// children; ties by age. A node is never visited more than its parent, so that none loses its own.
std::vector<ReportedNode> MostVisitedNodes(const SearchTree& tree, const NavigationGraph& graph,
                                           std::size_t limit);

/// One view of each cell and heading, with the most that it was worth, by cell and heading; at most
/// `limit`, those worth most.
std::vector<ReportedView> MostOfEach(std::vector<ReportedView> views, std::size_t limit);

}  // namespace conav::planner
