#include <catch2/catch.hpp>
#include <cmath>

#include "common/msg/perception_model.h"

namespace conav::planner {
namespace {

TEST_CASE("a seen discrepancy is mended less likely the farther it is", "[planner][search]") {
  PerceptionQuery query;
  query.belief = BeliefGrid(5, 7, 0.0F);
  query.belief[{2, 2}] = 1.0F;
  query.cell = {2, 1};
  query.visible.free = {{2, 1}, {2, 2}, {2, 3}};
  query.visible.walls = {{2, 5}};
  FakePerceptionModel model;
  const auto answers = model.Predict({&query, 1});
  REQUIRE(answers.has_value());
  CHECK(answers->at(0).remove[{2, 2}] == Approx(0.6 * std::exp(-0.15)));
  CHECK(answers->at(0).add[{2, 5}] == Approx(0.6 * std::exp(-0.6)));
  CHECK(ExpectedEdits(answers->at(0)) == Approx(0.6 * (std::exp(-0.15) + std::exp(-0.6))));
}

TEST_CASE("a wall where the robot has been is removed almost surely", "[planner][search]") {
  PerceptionQuery query;
  query.belief = BeliefGrid(5, 5, 1.0F);
  query.cell = {2, 2};
  query.path = {{2, 3}, {2, 2}};
  const auto answers = FakePerceptionModel().Predict({&query, 1});
  REQUIRE(answers.has_value());
  CHECK(ExpectedEdits(answers->at(0)) == Approx(1.8));
}

}  // namespace
}  // namespace conav::planner
