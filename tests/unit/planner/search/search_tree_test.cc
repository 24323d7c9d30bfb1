#include "planner/search/search_tree.h"

#include <catch2/catch.hpp>
#include <numbers>

namespace conav::planner {
namespace {

SearchNode Child(int parent, int action, double reward = 0.0, double feasibility = 1.0) {
  SearchNode node;
  node.parent = parent;
  node.action = action;
  node.reward = reward;
  node.feasibility = feasibility;
  return node;
}

constexpr double kExploration = std::numbers::sqrt2;  // the paper's

TEST_CASE("a backup propagates the sample with rewards and discount", "[planner][search]") {
  SearchTree tree(0);
  const int a = tree.Add(Child(SearchTree::kRoot, 0, -1.0));
  const int b = tree.Add(Child(a, 0, -2.0));
  tree.Backup(b, 10.0, 0.5);
  CHECK(tree.node(b).total_return == Approx(-2.0 + 0.5 * 10.0));  // 3
  CHECK(tree.node(a).total_return == Approx(-1.0 + 0.5 * 3.0));   // 0.5
  CHECK(tree.node(SearchTree::kRoot).total_return == Approx(0.0 + 0.5 * 0.5));
  CHECK(tree.node(a).visit_count == 1);
}

TEST_CASE("above an uncertain move the estimate takes the place of what may not happen",
          "[planner][search]") {
  SearchTree tree(0);
  const int a = tree.Add(Child(SearchTree::kRoot, 0, -1.0));
  tree.Backup(a, 4.0, 1.0);  // Q(a) = 3, N(a) = 1
  const int b = tree.Add(Child(a, 0, -2.0, 0.25));
  tree.Backup(b, 10.0, 1.0);
  CHECK(tree.node(b).total_return == Approx(8.0));  // its own delta does not weigh its rollout
  // At a: delta = 0.25 of b, Q(a)/N(a) = 3 before this visit.
  const double at_a = -1.0 + (0.25 * 8.0 + 0.75 * 3.0);
  CHECK(tree.node(a).total_return == Approx(3.0 + at_a));
  CHECK(tree.node(a).visit_count == 2);
  CHECK(tree.node(SearchTree::kRoot).total_return == Approx(3.0 + at_a));
  SearchTree fresh(0);  // an unvisited node's estimate is 0
  const int unvisited = fresh.Add(Child(SearchTree::kRoot, 0, 0.0));
  fresh.Backup(fresh.Add(Child(unvisited, 0, 0.0, 0.5)), 8.0, 1.0);
  CHECK(fresh.node(unvisited).total_return == Approx(0.5 * 8.0));
}

TEST_CASE("selection takes the largest upper confidence bound", "[planner][search]") {
  SearchTree tree(0);
  const int good = tree.Add(Child(SearchTree::kRoot, 0, 1.0));
  const int rare = tree.Add(Child(SearchTree::kRoot, 1, 0.5));
  Random random(1);
  tree.Backup(rare, 0.0, 1.0);
  // N(root) = n + 1: 1 + sqrt 2 sqrt(log(n + 1) / n) against 0.5 + sqrt 2 sqrt(log(n + 1))
  tree.Backup(good, 0.0, 1.0);
  CHECK(tree.SelectChild(SearchTree::kRoot, kExploration, random) == good);
  for (int i = 0; i < 2; ++i) tree.Backup(good, 0.0, 1.0);  // 1 + 0.961 against 0.5 + 1.665
  CHECK(tree.SelectChild(SearchTree::kRoot, kExploration, random) == rare);
  for (int i = 0; i < 6; ++i) tree.Backup(good, 0.0, 1.0);
  for (int i = 0; i < 2; ++i) tree.Backup(rare, 0.0, 1.0);  // 1 + 0.743 against 0.5 + 1.287
  CHECK(tree.SelectChild(SearchTree::kRoot, kExploration, random) == rare);
}

TEST_CASE("equal bounds are chosen between at random", "[planner][search]") {
  SearchTree tree(0);
  for (int action = 0; action < 3; ++action) {
    tree.Backup(tree.Add(Child(SearchTree::kRoot, action, 1.0)), 0.0, 1.0);
  }
  Random random(5);
  std::vector<int> counts(4, 0);
  for (int i = 0; i < 3000; ++i) {
    ++counts[static_cast<std::size_t>(tree.SelectChild(SearchTree::kRoot, kExploration, random))];
  }
  for (int child = 1; child <= 3; ++child) {
    CHECK(counts[static_cast<std::size_t>(child)] > 900);
  }
}

TEST_CASE("the choice is the most visited, then the better, then the first", "[planner][search]") {
  SearchTree tree(0);
  CHECK(tree.MostVisitedChild(SearchTree::kRoot) == -1);
  const int third = tree.Add(Child(SearchTree::kRoot, 2, 1.0));
  const int first = tree.Add(Child(SearchTree::kRoot, 0, 1.0));
  const int better = tree.Add(Child(SearchTree::kRoot, 1, 2.0));
  tree.Backup(third, 0.0, 1.0);
  CHECK(tree.MostVisitedChild(SearchTree::kRoot) == third);
  tree.Backup(first, 0.0, 1.0);
  CHECK(tree.MostVisitedChild(SearchTree::kRoot) == first);
  tree.Backup(better, 0.0, 1.0);
  CHECK(tree.MostVisitedChild(SearchTree::kRoot) == better);
  tree.Backup(third, 0.0, 1.0);
  CHECK(tree.MostVisitedChild(SearchTree::kRoot) == third);
}

}  // namespace
}  // namespace conav::planner
