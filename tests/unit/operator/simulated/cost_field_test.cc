#include <catch2/catch.hpp>

#include "operator/simulated/path_planner.h"

namespace conav::operators {
namespace {

TEST_CASE("The cost to a cell is the sum of the entry costs on the cheapest way",
          "[operator][simulated]") {
  // 1 9 1
  // 1 1 1
  Grid<double> costs(2, 3, 1.0);
  costs[{0, 1}] = 9.0;
  const CostField field(costs, {0, 0});

  CHECK(field.CostTo({0, 0}) == 0.0);
  CHECK(field.CostTo({0, 1}) == 9.0);
  CHECK(field.CostTo({0, 2}) == 4.0);  // around: down, east, east, up
  CHECK(field.PathTo({0, 2}) == std::vector<Cell>{{0, 0}, {1, 0}, {1, 1}, {1, 2}, {0, 2}});
}

TEST_CASE("A cell behind cells that are never entered has no finite cost",
          "[operator][simulated]") {
  Grid<double> costs(1, 3, 1.0);
  costs[{0, 1}] = kUnreachable;
  const CostField field(costs, {0, 0});
  CHECK(field.CostTo({0, 2}) == kUnreachable);
}

TEST_CASE("Among ways of equal cost the choice is always the same", "[operator][simulated]") {
  const CostField field(Grid<double>(2, 2, 1.0), {0, 0});
  // (0,1) is settled before (1,0), so it is the one that (1,1) is entered from.
  CHECK(field.PathTo({1, 1}) == std::vector<Cell>{{0, 0}, {0, 1}, {1, 1}});
}

TEST_CASE("The path to the source is the source alone", "[operator][simulated]") {
  const CostField field(Grid<double>(1, 1, 1.0), {0, 0});
  CHECK(field.PathTo({0, 0}) == std::vector<Cell>{{0, 0}});
}

}  // namespace
}  // namespace conav::operators
