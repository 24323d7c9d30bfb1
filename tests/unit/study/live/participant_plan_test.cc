#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "study/design.h"
#include "study/live/protocol.h"
#include "support/refusal.h"

namespace conav::live_study {
namespace {

Part Methods(std::vector<std::uint64_t> layouts = {234, 666, 9}) {
  Part part;
  part.kind = Part::Kind::kMethods;
  part.where = "parts[2]";
  part.title = "Part {part} of {parts}";
  part.methods = {study::kStudyMethods.begin(), study::kStudyMethods.end()};
  part.layouts = std::move(layouts);
  Part rest;
  rest.kind = Part::Kind::kRest;
  rest.id = "baseline";
  part.before = {rest};
  Part form;
  form.id = "tlx";
  form.form = "forms/tlx.json";
  part.after = {form};
  return part;
}

Part Training(int attempts, std::vector<std::uint64_t> layouts = {}) {
  Part part;
  part.kind = Part::Kind::kMaze;
  part.where = "parts[1]";
  part.id = "training";
  part.training = true;
  part.criterion = {attempts, 0.5};
  part.layouts = std::move(layouts);
  return part;
}

Protocol Of(std::vector<Part> parts) {
  Protocol protocol;
  protocol.parts = std::move(parts);
  return protocol;
}

std::vector<std::string> Ids(const ParticipantPlan& plan) {
  std::vector<std::string> ids;
  for (const Step& step : plan.steps) ids.push_back(step.id);
  return ids;
}

const Step& Find(const ParticipantPlan& plan, const std::string& id) {
  for (const Step& step : plan.steps) {
    if (step.id == id) return step;
  }
  FAIL(id);
  return plan.steps.front();
}

TEST_CASE("methods are expanded in the participant's order, with what comes before and after",
          "[live_study]") {
  const auto plan = PlanParticipant(Of({Training(2, {1, 2}), Methods()}), "P01", 0);
  REQUIRE(plan);
  CHECK(Ids(*plan) == std::vector<std::string>{"training", "training-2", "ig-mcts-baseline",
                                               "ig-mcts", "ig-mcts-tlx", "instruction-baseline",
                                               "instruction", "instruction-tlx", "teleop-baseline",
                                               "teleop", "teleop-tlx"});
  CHECK(plan->order == 1);
  CHECK(plan->count() == 10);  // attempts share a number
  const Step& last = Find(*plan, "teleop");
  CHECK(last.title == "Part 3 of 3");
  CHECK(last.method == MethodKind::kTeleop);
  CHECK(Find(*plan, "teleop-tlx").method == MethodKind::kTeleop);
  const auto design = DesignOf(*plan);
  CHECK(design["parts"][1]["training"] == true);
  CHECK(design["parts"][3]["layout"] == std::to_string(plan->steps[3].seed));
  CHECK_THAT(Describe(*plan), Catch::Contains("instruction-tlx"));
}

TEST_CASE("consecutive participants balance orders, and methods with layouts", "[live_study]") {
  std::map<std::string, int> first;
  std::map<std::pair<std::string, std::uint64_t>, int> pairs;
  for (int number = 1; number <= 18; ++number) {
    const auto plan = PlanParticipant(Of({Methods()}), fmt::format("P{:02}", number), 0);
    REQUIRE(plan);
    ++first[plan->steps[1].id];
    std::set<std::uint64_t> layouts;
    for (const MethodKind method : study::kStudyMethods) {
      const Step& step = Find(*plan, std::string(Name(method)));
      layouts.insert(step.seed);
      ++pairs[{step.id, step.seed}];
    }
    CHECK(layouts.size() == 3);
  }
  CHECK(first.size() == 3);
  for (const auto& [id, count] : first) CHECK(count == 6);
  CHECK(pairs.size() == 9);
  for (const auto& [pair, count] : pairs) CHECK(count == 6);
}

TEST_CASE("a row of the design may be asked for", "[live_study]") {
  const auto plan = PlanParticipant(Of({Methods()}), "P01", 6);
  REQUIRE(plan);
  CHECK(plan->order == 6);
  test::CheckRefusal(PlanParticipant(Of({Methods()}), "P01", 7), Catch::StartsWith("--order 7"),
                     ErrorCode::kOutOfRange);
}

TEST_CASE("a participant's number is that at the end of the code", "[live_study]") {
  CHECK(NumberOf("P01") == 0);
  CHECK(NumberOf("2026-17") == 16);
  CHECK(NumberOf("0") == 0);
  CHECK(NumberOf("anna") == NumberOf("anna"));
  CHECK(NumberOf("anna") != NumberOf("bert"));
}

TEST_CASE("no two mazes of a participant have the same layout, training included", "[live_study]") {
  test::CheckRefusal(PlanParticipant(Of({Training(1, {666}), Methods()}), "P01", 0),
                     Catch::Contains("parts[2].layouts") && Catch::Contains("666"),
                     ErrorCode::kInvalidArgument);
  const auto plan = PlanParticipant(Of({Training(3), Methods({})}), "P01", 0);
  REQUIRE(plan);
  std::set<std::uint64_t> seeds;
  for (const Step& step : plan->steps) {
    if (step.is_maze()) seeds.insert(step.seed);
  }
  CHECK(seeds.size() == 6);
  const auto again = PlanParticipant(Of({Training(3), Methods({})}), "P01", 0);
  CHECK(DesignOf(*again) == DesignOf(*plan));
}

TEST_CASE("layouts that are repeated are turned another way each time", "[live_study]") {
  Part part = Methods();
  part.repeat_layouts = true;
  part.mazes_per_method = 3;
  const auto plan = PlanParticipant(Of({part}), "P04", 0);
  REQUIRE(plan);
  std::map<std::uint64_t, std::set<int>> rotations;
  for (const Step& step : plan->steps) {
    if (step.is_maze()) rotations[step.seed].insert(step.rotation_deg);
  }
  CHECK(rotations.size() == 3);
  for (const auto& [layout, turned] : rotations) CHECK(turned.size() == 3);
}

TEST_CASE("the protocol that comes with conav fits each participant", "[live_study]") {
  const Protocol protocol = ReadProtocol(ShippedProtocol());
  for (int number = 1; number <= 6; ++number) {
    const auto plan = PlanParticipant(protocol, fmt::format("P{}", number), 0);
    REQUIRE(plan);
    CHECK(plan->order == number);
  }
}

TEST_CASE("impossible plans are refused", "[live_study]") {
  Part crowded = Training(1, {7});
  crowded.maze.robots = 32;
  crowded.maze.preset = "9x9";
  Part unknown = Training(1);
  unknown.maze.preset = "nowhere";
  for (const auto& [parts, named] : std::vector<std::pair<std::vector<Part>, std::string>>{
           {{crowded}, "parts[1]"},
           {{unknown}, "nowhere"},
           {{Training(1, {1}), Training(1, {2})}, "'training'"}}) {
    test::CheckRefusal(PlanParticipant(Of(parts), "P01", 0), Catch::Contains(named));
  }
}

TEST_CASE("each participant of the mapping task gets other mazes, the same ones again",
          "[live_study]") {
  const auto seeds = [](const std::string& participant, std::vector<std::uint64_t> layouts = {}) {
    std::vector<std::uint64_t> found;
    const int mazes = layouts.empty() ? 3 : static_cast<int>(layouts.size());
    const auto plan = PlanMappingTask({participant, mazes, layouts});
    REQUIRE(plan);
    for (const Step& step : plan->steps) found.push_back(step.seed);
    return found;
  };
  CHECK(seeds("P07") == seeds("P07"));
  CHECK(seeds("P07") != seeds("P08"));
  CHECK(seeds("P07", {7, 9}) == std::vector<std::uint64_t>{7, 9});
  test::CheckRefusal(PlanMappingTask({"P07", 2, {7, 7}}), Catch::StartsWith("--maze-seed"));
  test::CheckRefusal(PlanMappingTask({"P07", 3, {7}}), Catch::StartsWith("--maze-seed"));
  test::CheckRefusal(PlanMappingTask({"P07", 101}), Catch::StartsWith("--mazes 101"));
}

}  // namespace
}  // namespace conav::live_study
