#include <catch2/catch.hpp>
#include <vector>

#include "common/runtime/result.h"
#include "planner/explain/decision_file.h"
#include "planner/planner_service.h"
#include "support/full_disk.h"
#include "support/temporary_folder.h"

namespace conav::planner {
namespace {

Situation SomeSituation() {
  Situation situation;
  situation.state = {.robot = "r1", .cell = {1, 1}, .goals_left = {{2, 2}}, .path = {{1, 1}}};
  situation.map.cells = OccupancyGrid(3, 3, Occupancy::kFree);
  situation.belief.wall_probability = BeliefGrid(3, 3, 0.25F);
  situation.guidance = Guidance{.path = {{1, 1}, {1, 2}}};
  return situation;
}

Decision MoveEast() { return MoveAlong({{1, 2}, {2, 2}}); }

std::vector<DecisionRecord> Recorded(const std::filesystem::path& file) {
  std::vector<DecisionRecord> decisions;
  REQUIRE(ReadDecisions(
      file, [&](DecisionRecord&& decision) { decisions.push_back(std::move(decision)); }));
  return decisions;
}

TEST_CASE("a decision is recorded with the situation that it was made in", "[planner][record]") {
  const test::TemporaryFolder folder;
  DecisionRecording recording(folder / "decisions.pb.zst");
  recording.Record(MoveEast(), SomeSituation());
  CHECK(recording.recorded() == 1);
  const auto decisions = Recorded(folder / "decisions.pb.zst");
  REQUIRE(decisions.size() == 1);
  CHECK(decisions[0].map == SomeSituation().map.cells);
  CHECK(decisions[0].belief == SomeSituation().belief.wall_probability);
  CHECK(decisions[0].goals_left == std::vector<Cell>{{2, 2}});
  CHECK(decisions[0].path == std::vector<Cell>{{1, 1}});
  CHECK(decisions[0].guidance == std::vector<Cell>{{1, 1}, {1, 2}});
  CHECK(decisions[0].plan == std::vector<Cell>{{1, 2}, {2, 2}});
  CHECK(decisions[0].taken.target == Cell{1, 2});
  CHECK_FALSE(decisions[0].has_search());
}

TEST_CASE("a decision that finds the disk full is counted, and those after it are recorded",
          "[planner][record]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "decisions.pb.zst";
  DecisionRecording recording(file);
  recording.Record(MoveEast(), SomeSituation());
  {
    const test::FullDisk full(std::filesystem::file_size(file) + 10);
    recording.Record(MoveEast(), SomeSituation());
  }
  CHECK(recording.lost() == 1);
  recording.Record(MoveEast(), SomeSituation());
  CHECK(recording.recorded() == 2);
  CHECK(Recorded(file).size() == 2);
}

TEST_CASE("a planner that cannot record does not start", "[planner][record]") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_AS(DecisionRecording(folder / "none/decisions.pb.zst"), StartupError);
}

}  // namespace
}  // namespace conav::planner
