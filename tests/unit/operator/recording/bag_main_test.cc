#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "support/program_runner.h"
#include "unit/operator/recording/recordings.h"

namespace conav::bag {
namespace {

/// A run folder "run" with the small recording.
struct BagFixture : test::ProgramRunner {
  BagFixture() : ProgramRunner("conav-bag") {
    std::filesystem::create_directory(*this / "run");
    WriteSmallRecording(recording());
  }
  std::filesystem::path recording() const { return *this / "run/recording.mcap"; }
};

TEST_CASE("conav bag lists topics, types and counts of a run", "[operator][bag]") {
  const BagFixture desk;
  const auto outcome = desk.Run("run");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.error.empty());
  CHECK_THAT(outcome.out, Catch::Contains("run/recording.mcap: ") &&
                              Catch::Contains("5 messages, 0.0 s from 1970-01-01 00:00:00 UTC on"));
  CHECK_THAT(outcome.out, Catch::Contains("/a     std_msgs/msg/String         3\n"));
  CHECK_THAT(outcome.out, Catch::Contains("/b     std_msgs/msg/String         2\n"));
  CHECK(desk.Run("run/recording.mcap").out == outcome.out);
}

TEST_CASE("conav bag tells programs the same", "[operator][bag]") {
  const BagFixture desk;
  const auto outcome = desk.Run("run --json -");
  REQUIRE(outcome.exit_code == 0);
  CHECK_THAT(outcome.error, Catch::Contains("std_msgs/msg/String"));
  const auto json = nlohmann::json::parse(outcome.out);
  CHECK(json["messages"] == 5);
  CHECK(json["finished"] == true);
  CHECK(json["metadata"]["conav"]["version"] == "1.2");
  CHECK(json["topics"][1] ==
        nlohmann::json{{"topic", "/b"}, {"type", "std_msgs/msg/String"}, {"messages", 2}});
}

TEST_CASE("conav bag writes a rosbag2 folder, but over none", "[operator][bag]") {
  const BagFixture desk;
  const auto outcome = desk.Run("run --rosbag2 bag");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.out, Catch::Contains("written as rosbag2: bag"));
  CHECK(std::filesystem::file_size(desk / "bag/metadata.yaml") > 0);
  CHECK(std::filesystem::file_size(desk / "bag/bag_0.db3") > 0);
  const auto again = desk.Run("run --rosbag2 bag");
  CHECK(again.exit_code == 2);
  CHECK(again.error == "conav bag: --rosbag2 bag: exists already\n");
  CHECK(desk.Run("run --rosbag2 no/bag").exit_code == 1);
}

TEST_CASE("conav bag reads a recording that was cut off, with a warning", "[operator][bag]") {
  const BagFixture desk;
  std::filesystem::resize_file(desk.recording(), std::filesystem::file_size(desk.recording()) - 1);
  const auto outcome = desk.Run("run --json o.json");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.error,
             Catch::Contains("conav bag: warning: run/recording.mcap: the file was not finished"));
  CHECK(nlohmann::json::parse(ReadFile(desk / "o.json").value())["finished"] == false);
}

TEST_CASE("conav bag names what is wrong", "[operator][bag]") {
  const BagFixture desk;
  const auto none = desk.Run("nowhere");
  CHECK(none.exit_code == 1);
  CHECK_THAT(none.error, Catch::Contains("conav bag: nowhere: No such file"));
  std::filesystem::create_directory(desk / "empty");
  CHECK_THAT(desk.Run("empty").error, Catch::Contains("empty: no recording.mcap in it"));
  Store(desk / "text.mcap", TextMessage("no recording, but longer than a magic"));
  CHECK_THAT(desk.Run("text.mcap").error, Catch::Contains("text.mcap: no MCAP file"));
  CHECK(desk.Run("").exit_code == 2);
  CHECK(desk.Run("run --colour red").exit_code == 2);
  CHECK(desk.Run("run --json run/recording.mcap").exit_code == 2);
  CHECK(desk.Run("run >/dev/full").exit_code == 1);
}

}  // namespace
}  // namespace conav::bag
