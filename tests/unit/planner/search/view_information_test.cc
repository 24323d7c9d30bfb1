#include "planner/search/view_information.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/msg/perception_model.h"
#include "common/runtime/random.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// What a search asks about the views of a world.
struct Asking {
  explicit Asking(const TextWorld& world)
      : offered(world.problem), information(world.problem, offered, model), path(world.problem) {}

  std::vector<PerceptionQuery> asked;
  bool fails = false;
  ScriptedPerception model{[this](int, auto queries) -> ScriptedPerception::Answers {
    if (fails) return Fail(ErrorCode::kTimeout, "gone");
    asked.insert(asked.end(), queries.begin(), queries.end());
    return FakePerceptionModel().Predict(queries);
  }};
  OfferedActions offered;
  ViewInformation information;
  PathState path;
};

TEST_CASE("a view is asked about when it is wanted, and remembered", "[planner][search]") {
  const TextWorld world({"#####", "#S..#", "#####"});
  Asking asking(world);
  auto& [asked, fails, model, offered, information, path] = asking;
  const double first = information.Of(path, 2).value();
  CHECK(asked.size() == 1);
  CHECK(asked[0].heading_rad == world.graph.HeadingsAt(0)[2]);
  CHECK(information.Of(path, 2).value() == first);
  CHECK(model.calls == 1);
  REQUIRE(information.Of(path, 3).has_value());
  CHECK(model.calls == 2);
}

TEST_CASE("all views of a place can be asked in one call", "[planner][search]") {
  const TextWorld world({"#####", "#S..#", "#####"});
  Asking asking(world);
  auto& [asked, fails, model, offered, information, path] = asking;
  REQUIRE(information.AskAll(path).has_value());
  for (std::size_t view = 0; view < 8; ++view) REQUIRE(information.Of(path, view).has_value());
  CHECK(model.calls == 1);
  CHECK(asked.size() == 8);
  CHECK(information.counts().cached == 8);
  CHECK(asked[2].heading_rad == world.graph.HeadingsAt(0)[2]);
  CHECK(asked[2].visible == world.graph.ViewFrom(world.problem.start, 2));
}

TEST_CASE("views that cannot show enough are worth nothing and not asked about",
          "[planner][search]") {
  TextWorld world({"#####", "#S.##", "#####"}, {"#####", "#S#.#", "#####"});
  const std::size_t first = 8 * static_cast<std::size_t>(world.problem.start);
  world.problem.poor_views.assign(8 * static_cast<std::size_t>(world.graph.vertex_count()), 0);
  for (std::size_t view = 0; view < 8; ++view) {
    if (view != 0) world.problem.poor_views[first + view] = 1;
  }
  Asking asking(world);
  auto& [asked, fails, model, offered, information, path] = asking;
  CHECK(offered.At(world.problem.start).views.size() == 8);  // a branch may end with any
  REQUIRE(information.AskAll(path).has_value());
  REQUIRE(asked.size() == 1);
  CHECK(asked[0].heading_rad == world.graph.HeadingsAt(0)[0]);
  for (std::size_t view = 0; view < 8; ++view) {
    CHECK((information.Of(path, view).value() == 0.0) == (view != 0));
  }
  REQUIRE(information.AskAll(path).has_value());
  CHECK(model.calls == 1);
}

TEST_CASE("the path is asked about as a set: order and repeats do not matter",
          "[planner][search]") {
  const TextWorld world({"#####", "#.S.#", "#####"});
  Asking asking(world);
  auto& [asked, fails, model, offered, information, path] = asking;
  for (const Cell side : {Cell{1, 1}, Cell{1, 3}}) {
    path.Go(world.EdgeBetween({1, 2}, side));
    path.Go(world.EdgeBetween(side, {1, 2}));
  }
  REQUIRE(information.Of(path, 0).has_value());
  CHECK(asked[0].path == std::vector<Cell>{{1, 1}, {1, 2}, {1, 3}});
  path.TakeBack(0);
  for (const Cell side : {Cell{1, 3}, Cell{1, 1}}) {
    path.Go(world.EdgeBetween({1, 2}, side));
    path.Stay();
    path.Go(world.EdgeBetween(side, {1, 2}));
  }
  REQUIRE(information.Of(path, 0).has_value());
  CHECK(model.calls == 1);
  path.TakeBack(3);  // another path to the same place is another question
  REQUIRE(information.Of(path, 0).has_value());
  CHECK(model.calls == 2);
}

TEST_CASE("information is the sum of the expected edits, weighed by how far they are made",
          "[planner][search]") {
  TextWorld world({"#####", "#S.##", "#####"}, {"#####", "#S#.#", "#####"});
  const double edits = 0.6 * (std::exp(-0.15) + std::exp(-0.3));  // one wall less, one more
  Asking all(world);
  CHECK(all.information.Of(all.path, 0).value() == Approx(edits));  // east shows it
  CHECK(all.information.Of(all.path, 4).value() == 0.0);            // west does not
  world.problem.information_weight = 0.25;
  Asking quarter(world);
  CHECK(quarter.information.Of(quarter.path, 0).value() == Approx(0.25 * edits));
}

TEST_CASE("more places than expected are remembered, too", "[planner][search]") {
  const TextWorld world({"###########", "#S........#", "#.........#", "#.........#", "#.........#",
                         "#.........#", "#.........#", "#.........#", "###########"});
  Asking asking(world);
  auto& [asked, fails, model, offered, information, path] = asking;
  Random random(3);
  std::vector<std::pair<std::vector<Edge>, double>> walks;
  for (std::size_t i = 0; i < 4 * ViewInformation::kPlacesExpected; ++i) {
    std::vector<Edge> walk;
    for (int step = 0; step < 24; ++step) {
      const auto moves = offered.At(path.vertex()).moves;
      const auto last = static_cast<std::int64_t>(moves.size()) - 1;
      walk.push_back(moves[static_cast<std::size_t>(random.Uniform(0, last))]);
      path.Go(walk.back());
    }
    walks.emplace_back(walk, information.Of(path, 0).value());
    path.TakeBack(0);
  }
  const int calls = model.calls;
  REQUIRE(static_cast<std::size_t>(calls) > 2 * ViewInformation::kPlacesExpected);
  for (const auto& [walk, value] : walks) {
    for (const Edge& edge : walk) path.Go(edge);
    CHECK(information.Of(path, 0).value() == value);
    path.TakeBack(0);
  }
  CHECK(model.calls == calls);
}

TEST_CASE("a failing model is reported and asked again next time", "[planner][search]") {
  const TextWorld world({"###", "#S#", "###"});
  Asking asking(world);
  auto& [asked, fails, model, offered, information, path] = asking;
  fails = true;
  REQUIRE_FALSE(information.Of(path, 0).has_value());
  CHECK(information.Of(path, 0).error().code == ErrorCode::kTimeout);
  fails = false;
  CHECK(information.Of(path, 0).has_value());
}

TEST_CASE("views that were sent are not offered, others are", "[planner][search]") {
  TextWorld world({"#####", "#S..#", "#####"});
  world.problem.sent_views = {{{1, 1}, 0.0}, {{1, 1}, 3.14159265358979312}, {{1, 2}, 1.0}};
  OfferedActions offered(world.problem);
  const Actions actions = offered.At(world.problem.start);
  CHECK(actions.moves.size() == 1);
  CHECK(std::vector<int>(actions.views.begin(), actions.views.end()) ==
        std::vector<int>{1, 2, 3, 5, 6, 7});
  CHECK(offered.At(world.At(1, 2)).views.size() == 8);
  CHECK(actions.IsMove(0));
  CHECK_FALSE(actions.IsMove(1));
  CHECK(actions.ViewOf(1) == 0);
}

TEST_CASE("of views the most of each is kept, and of all those worth most", "[planner][search]") {
  const std::vector<ReportedView> views{{{2, 1}, 0.5, 1.0},
                                        {{1, 1}, 0.5, 2.0},
                                        {{1, 1}, 0.5, 3.0},
                                        {{1, 1}, 0.25, 0.5},
                                        {{1, 2}, 0.0, 0.75}};
  CHECK(MostOfEach(views, 10) ==
        std::vector<ReportedView>{
            {{1, 1}, 0.25, 0.5}, {{1, 1}, 0.5, 3.0}, {{1, 2}, 0.0, 0.75}, {{2, 1}, 0.5, 1.0}});
  CHECK(MostOfEach(views, 2) == std::vector<ReportedView>{{{1, 1}, 0.5, 3.0}, {{2, 1}, 0.5, 1.0}});
}

/// Of a robot that looks east; west of it the operator believes a wall.
Result<std::optional<BestView>> BestOfRoom(double least_information = 0.0, double turn_cost = 0.0) {
  const TextWorld world({"#####", "#GS.#", "#####"}, {"#####", "##S.#", "#####"});
  FakePerceptionModel model;
  return FindBestView(world.problem, model, least_information, turn_cost);
}

TEST_CASE("the best view is the one that shows the operator's mistake", "[planner][search]") {
  const BestView view = BestOfRoom().value().value();
  CHECK(std::cos(view.heading_rad) < 0.1);  // not eastwards; the lens is wide
  CHECK(view.information > 0.1);
  CHECK(view.views == 8);
}

TEST_CASE("a view with too little information is not offered, and a turn can outweigh information",
          "[planner][search]") {
  const BestView most = BestOfRoom().value().value();
  const BestView ahead = BestOfRoom(0.0, 100.0).value().value();
  CHECK(std::cos(ahead.heading_rad) == Approx(1.0));
  CHECK(ahead.information < most.information);
  CHECK(BestOfRoom(most.information, 100.0).value().value().heading_rad == most.heading_rad);
  CHECK_FALSE(BestOfRoom(most.information + 0.01, 100.0).value().has_value());
}

}  // namespace
}  // namespace conav::planner
