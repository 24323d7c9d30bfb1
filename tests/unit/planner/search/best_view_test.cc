#include <catch2/catch.hpp>
#include <cmath>

#include "common/msg/perception_model.h"
#include "planner/search/search_problem.h"
#include "planner/search/view_information.h"
#include "unit/planner/search/text_map.h"

using namespace conav;
using namespace conav::planner;

namespace {

const std::vector<std::string_view> kRoom{"#####", "#   #", "#####"};

struct Bench {
  Result<std::optional<BestView>> Find() {
    SearchProblem problem{.graph = graph, .start = *graph.VertexAt({1, 2}), .belief = belief};
    problem.goals_left = {{1, 1}};
    problem.sent_views = sent;
    return FindBestView(problem, model, least_information, turn_cost);
  }

  GridGraph graph{MapFrom(kRoom), {}};  // eight headings
  BeliefGrid belief = BeliefFrom(kRoom);
  std::vector<SentView> sent;
  FakePerceptionModel model;
  double least_information = 0.0;
  double turn_cost = 0.0;
};

}  // namespace

TEST_CASE("the best view is the one that shows the operator's mistake", "[planner][search]") {
  Bench bench;
  bench.belief[{1, 1}] = 1.0F;  // west of the robot, where the operator sees a wall
  const auto view = bench.Find();
  REQUIRE(view);
  REQUIRE(*view);
  CHECK(std::cos((*view)->heading_rad) < 0.1);  // not eastwards; the lens is wide
  CHECK((*view)->information > 0.1);
  CHECK((*view)->views == 8);
}

TEST_CASE("views that were sent are not the best one", "[planner][search]") {
  Bench bench;
  bench.belief[{1, 1}] = 1.0F;
  const double first = (*bench.Find())->heading_rad;
  bench.sent = {{{1, 2}, first}};
  CHECK((*bench.Find())->heading_rad != first);
  CHECK((*bench.Find())->views == 7);
  for (const double heading : bench.graph.HeadingsAt(0)) bench.sent.push_back({{1, 2}, heading});
  const auto none = bench.Find();
  REQUIRE(none);
  CHECK_FALSE(*none);
}

TEST_CASE("a view that tells too little is not offered, and a turn can cost more than it tells",
          "[planner][search]") {
  Bench bench;
  bench.belief[{1, 1}] = 1.0F;
  const BestView most = **bench.Find();
  bench.turn_cost = 100.0;
  const BestView ahead = **bench.Find();  // the robot looks east, away from the mistake
  CHECK(std::cos(ahead.heading_rad) == Approx(1.0));
  CHECK(ahead.information < most.information);
  bench.least_information = most.information;
  CHECK((*bench.Find())->heading_rad == most.heading_rad);
  bench.least_information = most.information + 0.01;
  CHECK_FALSE(*bench.Find());
}
