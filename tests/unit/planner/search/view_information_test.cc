#include "planner/search/view_information.h"

#include <catch2/catch.hpp>

#include "common/msg/perception_model.h"
#include "common/runtime/random.h"
#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// Counts what is asked; answers like the fake.
class CountingModel final : public PerceptionModel {
 public:
  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override {
    if (fails) return Fail(ErrorCode::kTimeout, "gone");
    ++calls;
    asked.insert(asked.end(), queries.begin(), queries.end());
    return fake_.Predict(queries);
  }
  ModelIdentity identity() const override { return {"counting", "", ""}; }

  bool fails = false;
  int calls = 0;
  std::vector<PerceptionQuery> asked;

 private:
  FakePerceptionModel fake_;
};

TEST_CASE("a view is asked about when it is wanted, and remembered", "[planner][search]") {
  const TextWorld world({"#####", "#S..#", "#####"});
  CountingModel model;
  const OfferedActions offered(world.problem);
  ViewInformation information(world.problem, offered, model);
  const PathState path(world.problem);
  const double first = information.Of(path, 2).value();
  CHECK(model.asked.size() == 1);
  CHECK(model.asked[0].heading_rad == world.graph.HeadingsAt(0)[2]);
  CHECK(information.Of(path, 2).value() == first);
  CHECK(model.calls == 1);
  REQUIRE(information.Of(path, 3).has_value());
  CHECK(model.calls == 2);
}

TEST_CASE("all views of a place can be asked in one call", "[planner][search]") {
  const TextWorld world({"#####", "#S..#", "#####"});
  CountingModel model;
  const OfferedActions offered(world.problem);
  ViewInformation information(world.problem, offered, model);
  const PathState path(world.problem);
  REQUIRE(information.AskAll(path).has_value());
  for (std::size_t view = 0; view < 8; ++view) REQUIRE(information.Of(path, view).has_value());
  CHECK(model.calls == 1);
  CHECK(model.asked.size() == 8);
  CHECK(information.counts().cached == 8);
  CHECK(model.asked[2].heading_rad == world.graph.HeadingsAt(0)[2]);
  CHECK(model.asked[2].visible == world.graph.ViewFrom(world.problem.start, 2));
}

TEST_CASE("what an operator is expected to do is weighed by how far they do so",
          "[planner][search]") {
  TextWorld world({"#####", "#G#S#", "#####"}, {"#####", "#G.S#", "#####"});
  CountingModel model;
  const OfferedActions offered(world.problem);
  const PathState path(world.problem);
  const double all = ViewInformation(world.problem, offered, model).Of(path, 4).value();
  world.problem.information_weight = 0.25;
  REQUIRE(all > 0.0);
  CHECK(ViewInformation(world.problem, offered, model).Of(path, 4).value() == 0.25 * all);
}

TEST_CASE("the path is asked about as a set: order and repeats do not matter",
          "[planner][search]") {
  const TextWorld world({"#####", "#.S.#", "#####"});
  CountingModel model;
  const OfferedActions offered(world.problem);
  ViewInformation information(world.problem, offered, model);
  PathState path(world.problem);
  for (const Cell side : {Cell{1, 1}, Cell{1, 3}}) {
    path.Go(world.EdgeBetween({1, 2}, side));
    path.Go(world.EdgeBetween(side, {1, 2}));
  }
  REQUIRE(information.Of(path, 0).has_value());
  CHECK(model.asked[0].path == std::vector<Cell>{{1, 1}, {1, 2}, {1, 3}});
  path.TakeBack(0);
  for (const Cell side : {Cell{1, 3}, Cell{1, 1}}) {
    path.Go(world.EdgeBetween({1, 2}, side));
    path.Stay();
    path.Go(world.EdgeBetween(side, {1, 2}));
  }
  REQUIRE(information.Of(path, 0).has_value());
  CHECK(model.calls == 1);
}

TEST_CASE("another path to the same place is another question", "[planner][search]") {
  const TextWorld world({"#####", "#.S.#", "#####"});
  CountingModel model;
  const OfferedActions offered(world.problem);
  ViewInformation information(world.problem, offered, model);
  PathState path(world.problem);
  REQUIRE(information.Of(path, 0).has_value());
  path.Go(world.EdgeBetween({1, 2}, {1, 1}));
  path.Go(world.EdgeBetween({1, 1}, {1, 2}));
  REQUIRE(information.Of(path, 0).has_value());
  CHECK(model.calls == 2);
}

TEST_CASE("information is the sum of the expected edits", "[planner][search]") {
  const TextWorld world({"#####", "#S..#", "#####"}, {"#####", "#S#.#", "#####"});
  FakePerceptionModel model;
  const OfferedActions offered(world.problem);
  ViewInformation information(world.problem, offered, model);
  const PathState path(world.problem);
  CHECK(information.Of(path, 0).value() == Approx(0.6 * std::exp(-0.15)));  // east shows it
  CHECK(information.Of(path, 4).value() == 0.0);                            // west does not
}

TEST_CASE("more places than expected are remembered, too", "[planner][search]") {
  const TextWorld world({"###########", "#S........#", "#.........#", "#.........#", "#.........#",
                         "#.........#", "#.........#", "#.........#", "###########"});
  CountingModel model;
  const OfferedActions offered(world.problem);
  ViewInformation information(world.problem, offered, model);
  PathState path(world.problem);
  Random random(3);
  std::vector<std::pair<std::vector<Edge>, double>> asked;
  for (std::size_t i = 0; i < 4 * ViewInformation::kPlacesExpected; ++i) {
    std::vector<Edge> walk;
    for (int step = 0; step < 24; ++step) {
      const auto moves = offered.At(path.vertex()).moves;
      const auto last = static_cast<std::int64_t>(moves.size()) - 1;
      walk.push_back(moves[static_cast<std::size_t>(random.Uniform(0, last))]);
      path.Go(walk.back());
    }
    asked.emplace_back(walk, information.Of(path, 0).value());
    path.TakeBack(0);
  }
  const int calls = model.calls;
  REQUIRE(static_cast<std::size_t>(calls) > 2 * ViewInformation::kPlacesExpected);
  for (const auto& [walk, value] : asked) {
    for (const Edge& edge : walk) path.Go(edge);
    CHECK(information.Of(path, 0).value() == value);
    path.TakeBack(0);
  }
  CHECK(model.calls == calls);
}

TEST_CASE("a failing model is reported and asked again next time", "[planner][search]") {
  const TextWorld world({"###", "#S#", "###"});
  CountingModel model;
  model.fails = true;
  const OfferedActions offered(world.problem);
  ViewInformation information(world.problem, offered, model);
  const PathState path(world.problem);
  REQUIRE_FALSE(information.Of(path, 0).has_value());
  CHECK(information.Of(path, 0).error().code == ErrorCode::kTimeout);
  model.fails = false;
  CHECK(information.Of(path, 0).has_value());
}

TEST_CASE("views that were sent are not offered, others are", "[planner][search]") {
  TextWorld world({"#####", "#S..#", "#####"});
  world.problem.sent_views = {{{1, 1}, 0.0}, {{1, 1}, 3.14159265358979312}, {{1, 2}, 1.0}};
  const OfferedActions offered(world.problem);
  const Actions actions = offered.At(world.problem.start);
  CHECK(actions.moves.size() == 1);
  CHECK(std::vector<int>(actions.views.begin(), actions.views.end()) ==
        std::vector<int>{1, 2, 3, 5, 6, 7});
  CHECK(offered.At(world.At(1, 2)).views.size() == 8);
  CHECK(actions.IsMove(0));
  CHECK_FALSE(actions.IsMove(1));
  CHECK(actions.ViewOf(1) == 0);
}

}  // namespace
}  // namespace conav::planner
