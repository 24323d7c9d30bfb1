#include "planner/explain/tree_layout.h"

#include <algorithm>
#include <numeric>

#include "planner/explain/action_names.h"

namespace conav::planner {
namespace {

using Tree = std::vector<ReportedNode>;

std::size_t Index(int number) { return static_cast<std::size_t>(number); }

std::vector<int> Depths(const Tree& tree) {
  std::vector<int> depths(tree.size(), 0);
  for (std::size_t i = 1; i < tree.size(); ++i) depths[i] = depths[Index(tree[i].parent)] + 1;
  return depths;
}

bool IsTaken(const ReportedNode& node, const SearchAction& taken) {
  return IsSameCommand({.kind = node.kind, .target = node.target, .heading_rad = node.heading_rad},
                       taken);
}

/// Nodes to draw, ascending. Whoever is drawn is visited no more than its parent, which comes first.
std::vector<std::size_t> Chosen(const Tree& tree, const std::vector<int>& depths, std::size_t limit,
                                int depth) {
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (depths[i] <= depth) nodes.push_back(i);
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [&](std::size_t a, std::size_t b) { return tree[a].visits > tree[b].visits; });
  if (nodes.size() > limit) nodes.resize(limit);
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

class Layout {
 public:
  Layout(const DecisionRecord& decision, std::size_t limit, int depth)
      : tree_(decision.report.tree), depths_(Depths(tree_)) {
    for (const std::size_t node : Chosen(tree_, depths_, limit, depth)) Add(node);
    MarkLine(decision.taken);
    if (!layout_.nodes.empty()) Place(0);
  }

  TreeLayout Take() { return std::move(layout_); }

 private:
  void Add(std::size_t node) {
    const auto at = [&](const PlacedNode& placed) {
      return static_cast<int>(placed.node) == tree_[node].parent;
    };
    const auto parent = std::find_if(layout_.nodes.begin(), layout_.nodes.end(), at);
    const int index =
        parent == layout_.nodes.end() ? -1 : static_cast<int>(parent - layout_.nodes.begin());
    layout_.nodes.push_back({.node = node, .parent = index, .depth = depths_[node]});
    layout_.depth = std::max(layout_.depth, depths_[node]);
  }

  std::vector<std::size_t> ChildrenOf(std::size_t placed) const {
    std::vector<std::size_t> children;
    for (std::size_t i = placed + 1; i < layout_.nodes.size(); ++i) {
      if (layout_.nodes[i].parent == static_cast<int>(placed)) children.push_back(i);
    }
    std::stable_sort(children.begin(), children.end(),
                     [&](std::size_t a, std::size_t b) { return Visits(a) > Visits(b); });
    return children;
  }

  std::uint32_t Visits(std::size_t placed) const {
    return tree_[layout_.nodes[placed].node].visits;
  }

  void MarkLine(const SearchAction& taken) {
    if (layout_.nodes.empty()) return;
    layout_.nodes[0].on_line = true;
    std::size_t node = 0;
    for (const std::size_t child : ChildrenOf(0)) {
      if (IsTaken(tree_[layout_.nodes[child].node], taken)) node = child;
    }
    while (node != 0) {
      layout_.nodes[node].on_line = true;
      const auto children = ChildrenOf(node);
      node = children.empty() ? 0 : children.front();
    }
  }

  void Place(std::size_t placed) {
    const auto children = ChildrenOf(placed);
    if (children.empty()) {
      layout_.nodes[placed].row = layout_.rows++;
      return;
    }
    for (const std::size_t child : children) Place(child);
    layout_.nodes[placed].row =
        std::midpoint(layout_.nodes[children.front()].row, layout_.nodes[children.back()].row);
  }

  const Tree& tree_;
  std::vector<int> depths_;
  TreeLayout layout_;
};

}  // namespace

TreeLayout LayOut(const DecisionRecord& decision, std::size_t limit, int depth) {
  return Layout(decision, limit, depth).Take();
}

}  // namespace conav::planner
