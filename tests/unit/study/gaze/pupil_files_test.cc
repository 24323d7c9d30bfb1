#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "study/gaze/eye_recording.h"
#include "support/program_runner.h"

namespace conav::gaze {
namespace {

using nlohmann::json;

/// Topic and message as Capture writes them: MessagePack in MessagePack.
std::string Packed(const std::string& topic, const json& message) {
  const auto inner = json::to_msgpack(message);
  const auto outer = json::to_msgpack(json::array({topic, json::binary(inner)}));
  return {outer.begin(), outer.end()};
}

json Pupil(double time) {
  return {{"id", 1}, {"timestamp", time}, {"confidence", 0.9}, {"diameter", 40.0}};
}

constexpr const char* kPositions =
    "pupil_timestamp,world_index,eye_id,confidence,norm_pos_x,norm_pos_y,diameter,method,diameter_"
    "3d\n"
    "2.0,0,0,0.9,0.5,0.5,41.0,2d c++,\n"
    "2.0,0,0,0.9,0.5,0.5,41.0,pye3d 0.3.0 real-time,3.5\r\n";

struct Folder {
  test::ProgramRunner gaze{"conav-gaze"};
  std::filesystem::path path = gaze / "000";

  Folder() { std::filesystem::create_directory(path); }
  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path / name).parent_path());
    REQUIRE(WriteFile(path / name, text));
  }
};

TEST_CASE("a recording of Capture is read, with the difference of its clocks", "[study][gaze]") {
  const Folder folder;
  folder.Write("pupil.pldata", Packed("pupil.1.2d", Pupil(5.0)) + Packed("pupil.1.2d", Pupil(4.0)));
  folder.Write(
      "info.player.json",
      R"({"recording_name": "P07", "start_time_system_s": 1000.5, "start_time_synced_s": 4})");
  const auto recording = ReadEyeRecording(folder.path);
  REQUIRE(recording);
  CHECK(recording->name == "P07");
  CHECK(recording->utc_offset_s == 996.5);
  REQUIRE(recording->pupils.size() == 2);
  CHECK(recording->pupils[0].time_s == 4.0);
}

TEST_CASE("an export counts before the messages, and what it lacks comes from them",
          "[study][gaze]") {
  const Folder folder;
  folder.Write("pupil.pldata", Packed("pupil.1.2d", Pupil(5.0)));
  folder.Write("annotation.pldata",
               Packed("annotation", {{"label", "trial begin"}, {"timestamp", 2.0}}));
  folder.Write("exports/000/pupil_positions.csv", "an older one");
  folder.Write("exports/001/pupil_positions.csv", kPositions);
  folder.Write("exports/001/blinks.csv", "id,start_timestamp,duration\n0,2.5,0.25\n");
  folder.Write("exports/001/surfaces/fixations_on_surface_map.csv",
               "fixation_id,start_timestamp,duration,norm_pos_x,norm_pos_y,on_surf\n"
               "7,2.0,150,0.1,0.2,True\n7,2.0,150,0.1,0.2,True\n8,3.0,150,1.1,0.2,False\n");
  folder.Write("exports/001/surfaces/gaze_positions_on_surface_map.csv",
               "gaze_timestamp,x_norm,y_norm,on_surf,confidence\n2.0,0.1,0.2,True,0.9\n");
  for (const auto& path : {folder.path, folder.path / "exports" / "001"}) {
    const auto recording = ReadEyeRecording(path);
    REQUIRE(recording);
    REQUIRE(recording->pupils.size() == 1);
    CHECK(recording->in_mm);
    CHECK(recording->pupils[0].diameter == 3.5);
    CHECK(recording->blinks.at(0).end_s == 2.75);
    CHECK(recording->surfaces.at("map").fixations.size() == 1);
    CHECK(recording->surfaces.at("map").gaze.size() == 1);
    CHECK(recording->marks.at(0).label == "trial begin");
  }
}

TEST_CASE("files of another format are refused by name and place", "[study][gaze]") {
  const Folder folder;
  CHECK(ReadEyeRecording(folder.path / "none").error().code == ErrorCode::kNotFound);
  CHECK_THAT(ReadEyeRecording(folder.path).error().text, Catch::Contains("has no pupils"));
  const std::string good = Packed("pupil.1.2d", Pupil(5.0));
  const std::string head = "pupil_timestamp,eye_id,confidence,diameter\n";
  struct Row {
    std::string file, text, complaint;
  };
  const std::vector<Row> rows = {
      {"pupil.pldata", good + good.substr(0, 30), fmt::format("byte {}", good.size())},
      {"pupil.pldata", "\x93\x01\x02\x03", "byte 0"},
      {"pupil.pldata", Packed("pupil.1.2d", 3), "no MessagePack map"},
      {"exports/0/pupil_positions.csv", head + "1.0,0,0.9,big\n", ":2: column diameter"},
      {"exports/0/pupil_positions.csv", head + "1.0,0,0.9\n", ":2: has 3 columns"},
      {"exports/0/pupil_positions.csv", "eye_id\n0\n", "no column pupil_timestamp"},
      {"exports/0/pupil_positions.csv", "eye_id,eye_id\n0,0\n", "twice"},
      {"exports/0/blinks.csv", "id\n0\n", "start_timestamp"},
      {"info.player.json", "{", "not JSON"}};
  for (const Row& row : rows) {
    INFO(row.file << ": " << row.complaint);
    std::filesystem::remove_all(folder.path);
    if (row.file.starts_with("exports")) folder.Write("exports/0/pupil_positions.csv", kPositions);
    folder.Write(row.file, row.text);
    const auto recording = ReadEyeRecording(folder.path);
    REQUIRE_FALSE(recording);
    CHECK(recording.error().code == ErrorCode::kMalformed);
    CHECK_THAT(recording.error().text,
               Catch::Contains(std::filesystem::path(row.file).filename()) &&
                   Catch::Contains(row.complaint));
  }
}

TEST_CASE("conav gaze: a recording without trials and wrong use", "[study][gaze]") {
  const Folder folder;
  folder.Write("pupil.pldata", Packed("pupil.1.2d", Pupil(5.0)));
  const auto without = folder.gaze.Run("000 --out eyes");
  CHECK(without.exit_code == 1);
  CHECK_THAT(without.error, Catch::Contains("trial begin"));
  CHECK_THAT(*ReadFile(folder.gaze / "eyes" / "trials.csv"), Catch::StartsWith("participant,"));
  folder.Write("marks.csv", "utc_s,label\n1,trial begin\n");
  const auto unplaced = folder.gaze.Run("000 --marks 000/marks.csv --out eyes");
  CHECK(unplaced.exit_code == 1);
  CHECK_THAT(unplaced.error, Catch::Contains("info.player.json"));
  for (const char* use : {"", "000 --confidence 2", "000 --marks none.csv", "000 --areas 000"}) {
    INFO(use);
    CHECK(folder.gaze.Run(use).exit_code == 2);
  }
}

}  // namespace
}  // namespace conav::gaze
