#include "planner/search/reported_tree.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace conav::planner {
namespace {

/// Numbers of the nodes to report, ascending.
std::vector<int> MostVisited(const SearchTree& tree, std::size_t limit) {
  std::vector<int> nodes(tree.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  if (nodes.size() <= limit) return nodes;
  const auto before = [&](int a, int b) {
    const auto visits_a = tree.node(a).visit_count;
    const auto visits_b = tree.node(b).visit_count;
    return visits_a != visits_b ? visits_a > visits_b : a < b;
  };
  std::nth_element(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(limit), nodes.end(),
                   before);
  nodes.resize(limit);
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

ReportedNode Describe(const SearchNode& node, const NavigationGraph& graph) {
  ReportedNode reported;
  reported.target = graph.CellOf(node.vertex);
  if (node.is_communication) {
    reported.kind = CommandKind::kTransmitView;
    reported.heading_rad = graph.HeadingsAt(node.vertex)[static_cast<std::size_t>(node.view)];
  }
  reported.visits = node.visit_count;
  reported.mean_value = node.mean();
  reported.feasibility = node.feasibility;
  return reported;
}

}  // namespace

std::vector<ReportedNode> MostVisitedNodes(const SearchTree& tree, const NavigationGraph& graph,
                                           std::size_t limit) {
  const std::vector<int> nodes = MostVisited(tree, limit);
  std::vector<ReportedNode> reported;
  reported.reserve(nodes.size());
  for (const int index : nodes) {
    reported.push_back(Describe(tree.node(index), graph));
    const auto parent = std::lower_bound(nodes.begin(), nodes.end(), tree.node(index).parent);
    if (tree.node(index).parent >= 0) {
      reported.back().parent = static_cast<int>(parent - nodes.begin());
    }
  }
  return reported;
}

std::vector<ReportedView> MostOfEach(std::vector<ReportedView> views, std::size_t limit) {
  const auto place = [](const ReportedView& view) {
    return std::tuple(view.cell.row, view.cell.column, view.heading_rad);
  };
  std::sort(views.begin(), views.end(), [&](const ReportedView& a, const ReportedView& b) {
    if (place(a) != place(b)) return place(a) < place(b);
    return a.information_gain > b.information_gain;
  });
  const auto same_place = [&](const ReportedView& a, const ReportedView& b) {
    return place(a) == place(b);
  };
  views.erase(std::unique(views.begin(), views.end(), same_place), views.end());
  if (views.size() <= limit) return views;
  std::stable_sort(views.begin(), views.end(), [](const ReportedView& a, const ReportedView& b) {
    return a.information_gain > b.information_gain;
  });
  views.resize(limit);
  std::sort(views.begin(), views.end(),
            [&](const ReportedView& a, const ReportedView& b) { return place(a) < place(b); });
  return views;
}

}  // namespace conav::planner
