#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <set>

#include "study/live/task_command.h"

namespace conav::mapping_task {
namespace {

constexpr std::array kOrder{MethodKind::kIgMcts, MethodKind::kInstruction, MethodKind::kTeleop};

TaskOptions Good() {
  TaskOptions options;
  options.participant = "P07";
  options.camera = "none";
  return options;
}

}  // namespace

TEST_CASE("a participant's code is a short pseudonym", "[mapping_task]") {
  for (const char* good : {"P07", "a_B-9"}) CHECK(IsParticipantCode(good));
  CHECK(IsParticipantCode(std::string(40, 'x')));
  CHECK_FALSE(IsParticipantCode(std::string(41, 'x')));
  for (const char* bad : {"", "Anna Schmidt", "../P07", "P\xC3\xA9"}) {
    CHECK_FALSE(IsParticipantCode(bad));
  }
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
  const std::vector<MethodKind> methods{kOrder.begin(), kOrder.end()};
  std::map<MethodKind, int> first;
  std::set<std::vector<MethodKind>> orders;
  for (int order = 1; order <= 6; ++order) {
    const auto ordered = MethodsInOrder(methods, order, "P07");
    REQUIRE(ordered);
    orders.insert(*ordered);
    ++first[ordered->front()];
  }
  CHECK(orders.size() == 6);
  for (const MethodKind method : methods) CHECK(first[method] == 2);
  CHECK(*MethodsInOrder(methods, 0, "P07") == *MethodsInOrder(methods, 0, "P07"));
  CHECK(orders.contains(*MethodsInOrder(methods, 0, "P07")));
  CHECK_THAT(MethodsInOrder(methods, 7, "P07").error().text, Catch::StartsWith("--order 7"));
  CHECK_FALSE(MethodsInOrder(methods, -1, "P07"));
}

TEST_CASE("a study has a method for each maze, the mapping task one of its own", "[mapping_task]") {
  TaskOptions options = Good();
  CHECK(MethodOf(options, 2) == MethodKind::kMapping);
  CHECK(FolderOf(options) == "runs/mapping-P07");
  options.methods = {kOrder.rbegin(), kOrder.rend()};
  CHECK(MethodOf(options, 1) == MethodKind::kTeleop);
  CHECK(FolderOf(options) == "runs/study-P07");
  CHECK(DesignOf(options)["methods"][0] == "teleop");
  options.out = "data/x";
  CHECK(FolderOf(options) == "data/x");
}

TEST_CASE("impossible options are rejected by the option and its value", "[mapping_task]") {
  using O = TaskOptions;
  for (const auto& [set, named] : std::vector<std::pair<void (*)(O&), std::string>>{
           {[](O&) {}, ""},  // accepted
           {[](O& o) { o.participant = "no name"; }, "--participant 'no name'"},
           {[](O& o) { o.mazes = 0; }, "--mazes 0"},
           {[](O& o) { o.mazes = 101; }, "--mazes 101"},
           {[](O& o) { o.maze_seeds.assign(2, 7); }, "--maze-seed"},  // for 3 mazes
           {[](O& o) { o.speed = 0.0; }, "--speed 0"},
           {[](O& o) { o.speed = std::nan(""); }, "--speed nan"},
           {[](O& o) { o.camera = "film"; }, "--camera film"},
           {[](O& o) { o.preset = "nowhere"; }, "--preset nowhere"}}) {
    O options = Good();
    set(options);
    const auto valid = Validate(options);
    INFO("expected: " << named);
    CHECK(valid.has_value() == named.empty());
    if (!valid) CHECK_THAT(valid.error().text, Catch::StartsWith(named));
  }
}

}  // namespace conav::mapping_task
