#include "unit/operator/console/state_bench.h"

namespace conav::operators {

TEST_CASE("a trail follows the robot cell by cell", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(At(1, {1, 1}, {{1, 1}}), 0.0);
  bench.state.Receive(At(2, {1, 2}, {{1, 1}, {1, 2}}), 0.0);
  const std::uint64_t before = bench.log.sequence();
  bench.state.Receive(At(3, {1, 2}, {{1, 1}, {1, 2}}), 0.0);
  CHECK(bench.log.sequence() == before + 1);  // the state, and no trail
  bench.state.Receive(At(4, {2, 2}, {{1, 1}, {1, 2}, {2, 2}}), 0.0);
  CHECK(bench.Trail() == "1,1 1,2 2,2");
}

TEST_CASE("a trail has the cells between two states that were heard", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(At(1, {1, 1}, {{1, 1}}), 0.0);
  bench.state.Receive(At(5, {1, 3}, {{1, 1}, {1, 2}, {1, 1}, {1, 2}, {1, 3}}), 0.0);
  CHECK(bench.Trail() == "1,1 1,2 1,1 1,2 1,3");
  bench.state.Receive(At(9, {1, 3}, {{1, 1}, {1, 2}, {1, 1}, {1, 2}, {1, 3}, {1, 4}, {1, 3}}), 0.0);
  CHECK(bench.Trail() == "1,1 1,2 1,1 1,2 1,3 1,4 1,3");
}

TEST_CASE("a trail goes on behind a picture whose way there was not heard", "[operator][console]") {
  StateBench bench;
  bench.state.Receive(At(1, {1, 1}, {{1, 1}}), 0.0);
  RobotState later = At(9, {5, 6}, {{5, 5}, {5, 6}});
  later.cell_moves = 20;
  bench.state.Receive(later, 0.0);
  CHECK(bench.Trail() == "1,1 5,5 5,6");
}

TEST_CASE("a robot that does not count its moves has a trail, too", "[operator][console]") {
  StateBench bench;
  const std::vector<std::vector<Cell>> paths{
      {{1, 1}}, {{1, 1}, {1, 2}, {1, 3}}, {}, {{1, 4}, {1, 5}}};
  const std::vector<Cell> cells{{1, 1}, {1, 3}, {1, 4}, {1, 5}};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    RobotState state = At(static_cast<std::int64_t>(i), cells[i], paths[i]);
    state.cell_moves = 0;
    bench.state.Receive(state, 0.0);
  }
  CHECK(bench.Trail() == "1,1 1,2 1,3 1,4 1,5");
}

TEST_CASE("a long trail comes in pieces, and only the last one again", "[operator][console]") {
  StateBench bench;
  std::vector<Cell> path;
  for (int i = 0; i < 130; ++i) path.push_back({0, i});
  bench.state.Receive(At(1, path.back(), path), 0.0);
  CHECK(AllOf(bench.log, Kind::kTrail).size() == 3);
  const std::uint64_t before = bench.log.sequence();
  path.push_back({0, 130});
  bench.state.Receive(At(2, path.back(), path), 0.0);
  const auto fresh = Parsed(bench.log.After(bench.log.generation(), before, SIZE_MAX));
  REQUIRE(fresh.size() == 2);
  CHECK(fresh[0].trail().first() == 128);
  CHECK(fresh[0].trail().cells_size() == 3);
}

}  // namespace conav::operators
