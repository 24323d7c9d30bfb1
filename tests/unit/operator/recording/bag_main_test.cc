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

TEST_CASE("conav bag lists topics, types and counts of a run, for people and programs",
          "[operator][bag]") {
  const BagFixture folder;
  const auto outcome = folder.Run("run");
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.error.empty());
  CHECK_THAT(outcome.out, Catch::Contains("run/recording.mcap: ") &&
                              Catch::Contains("5 messages") &&
                              Catch::Contains("1970-01-01 00:00:00 UTC"));
  CHECK_THAT(outcome.out, Catch::Contains("/a     std_msgs/msg/String         3\n"));
  CHECK(folder.Run("run/recording.mcap").out == outcome.out);
  const auto with_json = folder.Run("run --json - --rosbag2 bag");
  REQUIRE(with_json.exit_code == 0);
  CHECK_THAT(with_json.error, Catch::Contains("std_msgs/msg/String"));
  const auto json = nlohmann::json::parse(with_json.out);
  CHECK(json["messages"] == 5);
  CHECK(json["finished"] == true);
  CHECK(json["metadata"]["conav"]["version"] == "1.2");
  CHECK(json["topics"][1] ==
        nlohmann::json{{"topic", "/b"}, {"type", "std_msgs/msg/String"}, {"messages", 2}});
  CHECK(json["rosbag2"] == "bag");
  CHECK(std::filesystem::file_size(folder / "bag/metadata.yaml") > 0);
  CHECK(std::filesystem::file_size(folder / "bag/bag_0.db3") > 0);
}

TEST_CASE("conav bag reads a recording that was cut off, with a warning", "[operator][bag]") {
  const BagFixture folder;
  std::filesystem::resize_file(folder.recording(),
                               std::filesystem::file_size(folder.recording()) - 1);
  const auto outcome = folder.Run("run --json o.json");
  CHECK(outcome.exit_code == 0);
  CHECK_THAT(outcome.error, Catch::Contains("warning: run/recording.mcap: "));
  CHECK(nlohmann::json::parse(ReadFile(folder / "o.json").value())["finished"] == false);
}

TEST_CASE("conav bag names what is wrong", "[operator][bag]") {
  const BagFixture folder;
  std::filesystem::create_directory(folder / "empty");
  Store(folder / "text.mcap", TextMessage("no recording, but longer than a magic"));
  struct Row {
    std::string arguments;
    int exit_code;
    std::string names;
  };
  for (const Row& row : std::vector<Row>{
           {"nowhere", 2, "nowhere: "},
           {"empty", 1, "empty: "},
           {"text.mcap", 1, "text.mcap: "},
           {"", 2, "run"},
           {"run --colour red", 2, "--colour"},
           {"run --json run/recording.mcap", 2, "--json"},
           {"run --rosbag2 empty", 2, "--rosbag2 empty"},
           {"run --rosbag2 no/bag", 1, "no/bag"},
           {"run >/dev/full", 1, ""},
       }) {
    CAPTURE(row.arguments);
    const auto outcome = folder.Run(row.arguments);
    CHECK(outcome.exit_code == row.exit_code);
    CHECK_THAT(outcome.error, Catch::Contains(row.names));
  }
}

}  // namespace
}  // namespace conav::bag
