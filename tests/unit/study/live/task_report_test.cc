#include <catch2/catch.hpp>
#include <fstream>

#include "study/live/task_session.h"
#include "support/temporary_folder.h"

namespace conav::mapping_task {
namespace {

TaskOptions Options() {
  TaskOptions options;
  options.participant = "P07";
  options.maze_seeds = {7, 9, 11};
  return options;
}

MazeResult Of(double accuracy) {
  return {accuracy, {{"participant", "P07"}, {"mapping_accuracy", accuracy}, {"edits", 4}}};
}

}  // namespace

TEST_CASE("the report of a task counts the mazes that are finished and good enough to keep",
          "[mapping_task]") {
  const auto json = TaskJson(Options(), {Of(0.75), Of(0.5)});
  CHECK(json["participant"] == "P07");
  CHECK(json["complete"] == false);
  CHECK(json["mazes_wanted"] == 3);
  CHECK(json["mazes_finished"] == 2);
  CHECK(json["mazes_valid"] == 1);
  CHECK(json["mean_mapping_accuracy"] == 0.625);
  CHECK(json["mazes"][0]["valid"] == true);
  CHECK(json["mazes"][0]["seed"] == 7);
  CHECK(json["mazes"][0]["edits"] == 4);
  CHECK_FALSE(json["mazes"][0].contains("participant"));
  CHECK(json["mazes"][1]["valid"] == false);  // 50 % is not enough
}

TEST_CASE("a task is complete with its last maze, and reported before its first",
          "[mapping_task]") {
  CHECK(TaskJson(Options(), {Of(1), Of(1), Of(1)})["complete"] == true);
  CHECK(TaskJson(Options(), {})["mean_mapping_accuracy"] == 0.0);
}

TEST_CASE("a line tells how a maze went", "[mapping_task]") {
  CHECK_THAT(MazeLine(2, Of(0.734)), Catch::StartsWith("maze 2  mapping accuracy 73.4 %"));
  CHECK_THAT(MazeLine(2, Of(0.5)), Catch::EndsWith("(not valid: 50 % or less)"));
}

TEST_CASE("a maze's result is read back, another file is refused by its name", "[mapping_task]") {
  const test::TemporaryFolder folder;
  const auto read = [&] { return ReadMazeResult(folder / "result.json"); };
  const auto write = [&](const std::string& text) {
    std::ofstream(folder / "result.json") << text;
  };
  const auto none = read();
  REQUIRE(none);
  CHECK_FALSE(none->has_value());
  write(R"({"mapping_accuracy": 0.75})");
  const auto result = read();
  REQUIRE((result && *result));
  CHECK((*result)->mapping_accuracy == 0.75);
  for (const char* text : {"", "[]", "{}", R"({"mapping_accuracy": "good"})"}) {
    write(text);
    const auto refused = read();
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::kMalformed);
    CHECK_THAT(refused.error().text, Catch::Contains("result.json"));
  }
}

}  // namespace conav::mapping_task
