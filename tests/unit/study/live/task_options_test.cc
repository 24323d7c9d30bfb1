#include "study/live/task_options.h"

#include <catch2/catch.hpp>
#include <limits>
#include <map>
#include <set>

namespace conav::mapping_task {
namespace {

TaskOptions Good() {
  TaskOptions options;
  options.participant = "P07";
  options.camera = "none";
  return options;
}

std::string Refusal(const TaskOptions& options) {
  const auto valid = Validate(options);
  REQUIRE_FALSE(valid);
  return valid.error().text;
}

}  // namespace

TEST_CASE("a participant's code is a short pseudonym", "[mapping_task]") {
  CHECK(IsParticipantCode("P07"));
  CHECK(IsParticipantCode("a_B-9"));
  CHECK(IsParticipantCode(std::string(40, 'x')));
  CHECK_FALSE(IsParticipantCode(""));
  CHECK_FALSE(IsParticipantCode(std::string(41, 'x')));
  CHECK_FALSE(IsParticipantCode("Anna Schmidt"));
  CHECK_FALSE(IsParticipantCode("../P07"));
  CHECK_FALSE(IsParticipantCode("P\xC3\xA9"));
}

TEST_CASE("each participant gets mazes of their own, the same ones again", "[mapping_task]") {
  TaskOptions options = Good();
  const auto seeds = SeedsOf(options);
  CHECK(std::set<std::uint64_t>(seeds.begin(), seeds.end()).size() == 3);
  CHECK(SeedsOf(options) == seeds);
  options.mazes = 2;
  CHECK(SeedsOf(options) == std::vector(seeds.begin(), seeds.begin() + 2));
  options.participant = "P08";
  CHECK(SeedsOf(options)[0] != seeds[0]);
  options.maze_seeds = {7, 9};
  CHECK(SeedsOf(options) == std::vector<std::uint64_t>{7, 9});
}

TEST_CASE("over all orders of a study each method is as often at each place", "[mapping_task]") {
  const std::vector<std::string> methods{"ig-mcts", "instruction", "teleop"};
  std::map<std::string, int> first;
  std::set<std::vector<std::string>> orders;
  for (int order = 1; order <= 6; ++order) {
    const auto ordered = MethodsInOrder(methods, order, "P07");
    REQUIRE(ordered);
    orders.insert(*ordered);
    ++first[ordered->front()];
  }
  CHECK(orders.size() == 6);
  for (const std::string& method : methods) CHECK(first[method] == 2);
  CHECK(*MethodsInOrder(methods, 0, "P07") == *MethodsInOrder(methods, 0, "P07"));
  CHECK(orders.contains(*MethodsInOrder(methods, 0, "P07")));
  CHECK(MethodsInOrder(methods, 7, "P07").error().text == "--order 7: not between 1 and 6");
  CHECK_FALSE(MethodsInOrder(methods, -1, "P07"));
}

TEST_CASE("a study has a method for each maze, the mapping task one of its own", "[mapping_task]") {
  TaskOptions options = Good();
  CHECK(MethodOf(options, 2) == "mapping");
  options.methods = {"teleop", "ig-mcts", "instruction"};
  CHECK(Validate(options).has_value());
  CHECK(MethodOf(options, 2) == "ig-mcts");
  CHECK(FolderOf(options) == "runs/study-P07");
  CHECK(DesignOf(options)["methods"][0] == "teleop");
  options.methods[0] = "greedy";
  CHECK(Refusal(options) == "--methods: greedy is not one of ig-mcts, instruction, teleop");
  options.methods = {"teleop", "ig-mcts", "teleop"};
  CHECK(Refusal(options) == "--methods: teleop is named twice");
  options.methods = {"teleop"};
  CHECK(Refusal(options) == "--methods: 1 of them for 3 mazes");
}

TEST_CASE("the folder is the participant's, unless another one is named", "[mapping_task]") {
  TaskOptions options = Good();
  CHECK(FolderOf(options) == "runs/mapping-P07");
  options.out = "data/x";
  CHECK(FolderOf(options) == "data/x");
}

TEST_CASE("what cannot be is refused by the option and its value", "[mapping_task]") {
  TaskOptions options = Good();
  CHECK(Validate(options).has_value());
  options.participant = "no name";
  CHECK(Refusal(options) == "--participant 'no name': not 1 to 40 of A-Z a-z 0-9 _ -");
  options = Good();
  options.mazes = 0;
  CHECK(Refusal(options) == "--mazes 0: not between 1 and 100");
  options = Good();
  options.maze_seeds = {7, 9};
  CHECK(Refusal(options) == "--maze-seed: 2 of them for 3 mazes");
  options = Good();
  options.mazes = 101;
  CHECK(Refusal(options) == "--mazes 101: not between 1 and 100");
  options = Good();
  options.speed = 0.0;
  CHECK(Refusal(options) == "--speed 0: not above 0");
  options.speed = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(Refusal(options), Catch::StartsWith("--speed nan"));
  options = Good();
  options.camera = "film";
  CHECK_THAT(Refusal(options), Catch::StartsWith("--camera film"));
  options = Good();
  options.preset = "nowhere";
  CHECK_THAT(Refusal(options), Catch::StartsWith("--preset nowhere"));
}

}  // namespace conav::mapping_task
