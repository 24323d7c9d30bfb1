#include <sqlite3.h>
#include <yaml-cpp/yaml.h>

#include "operator/recording/mcap_file.h"
#include "support/full_disk.h"
#include "unit/operator/recording/recordings.h"

namespace conav::bag {
namespace {

/// Each row as its columns, joined by '|'.
std::vector<std::string> Rows(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  REQUIRE(sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr) == SQLITE_OK);
  std::vector<std::string> rows;
  const auto add = [](void* list, int count, char** values, char**) {
    std::string row;
    for (int i = 0; i < count; ++i) row.append(i > 0 ? "|" : "").append(values[i]);
    static_cast<std::vector<std::string>*>(list)->push_back(row);
    return 0;
  };
  CHECK(sqlite3_exec(database, sql.c_str(), add, &rows, nullptr) == SQLITE_OK);
  sqlite3_close(database);
  return rows;
}

TEST_CASE("A rosbag2 folder has every message, and its facts in metadata.yaml", "[operator][bag]") {
  const test::TemporaryFolder folder;
  const auto database = folder / "bag/bag_0.db3";
  WriteSmallRecording(folder / "a.mcap");
  McapReader reader = MustOpen(folder / "a.mcap");
  REQUIRE(WriteRosbag2(reader, folder / "bag", [](std::uint64_t) {}));
  CHECK(Rows(database,
             "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics") ==
        std::vector<std::string>{"1|/a|std_msgs/msg/String|cdr|- depth: 1\n",
                                 "2|/b|std_msgs/msg/String|cdr|- depth: 1\n"});
  CHECK(Rows(database, "SELECT topic_id, timestamp FROM messages ORDER BY id") ==
        std::vector<std::string>{"1|10", "2|20", "1|30", "1|40", "2|50"});
  CHECK(Rows(database, "SELECT hex(data) FROM messages WHERE timestamp = 10") ==
        std::vector<std::string>{"00010000040000006F6E6500"});
  CHECK(Rows(database, "SELECT schema_version FROM schema") == std::vector<std::string>{"3"});
  CHECK(Rows(database, "SELECT name FROM sqlite_master WHERE type = 'index'") ==
        std::vector<std::string>{"timestamp_idx"});
  const auto text = ReadFile(folder / "bag/metadata.yaml");
  REQUIRE(text);
  const YAML::Node bag = YAML::Load(*text)["rosbag2_bagfile_information"];
  CHECK(bag["storage_identifier"].as<std::string>() == "sqlite3");
  CHECK(bag["relative_file_paths"][0].as<std::string>() == "bag_0.db3");
  CHECK(bag["files"][0]["path"].as<std::string>() == "bag_0.db3");
  CHECK(bag["compression_format"].as<std::string>().empty());
  CHECK(bag["version"].as<int>() == 5);
  CHECK(bag["duration"]["nanoseconds"].as<int>() == 40);
  CHECK(bag["starting_time"]["nanoseconds_since_epoch"].as<int>() == 10);
  CHECK(bag["message_count"].as<int>() == 5);
  CHECK(bag["files"][0]["message_count"].as<int>() == 5);
  REQUIRE(bag["topics_with_message_count"].size() == 2);
  const YAML::Node b = bag["topics_with_message_count"][1];
  CHECK(b["message_count"].as<int>() == 2);
  CHECK(b["topic_metadata"]["name"].as<std::string>() == "/b");
  CHECK(b["topic_metadata"]["type"].as<std::string>() == "std_msgs/msg/String");
  CHECK(b["topic_metadata"]["serialization_format"].as<std::string>() == "cdr");
  CHECK(b["topic_metadata"]["offered_qos_profiles"].as<std::string>() == "- depth: 1\n");
  CHECK(Rows(database, "SELECT metadata FROM metadata") == std::vector<std::string>{*text});
}

TEST_CASE("A damaged chunk is left out of a rosbag2 folder, and said", "[operator][bag]") {
  const test::TemporaryFolder folder;
  WriteSmallRecording(folder / "a.mcap");
  Bytes bytes = BytesOf(folder / "a.mcap");
  bytes[PlaceOf(bytes, Opcode::kChunk, 1) + kRecordHeaderSize + 24] ^= 1;  // its CRC
  Store(folder / "a.mcap", bytes);
  McapReader reader = MustOpen(folder / "a.mcap");
  const auto left_out = WriteRosbag2(reader, folder / "bag", [](std::uint64_t) {});
  REQUIRE(left_out);
  REQUIRE(left_out->size() == 1);
  CHECK_THAT(left_out->at(0), Catch::Contains("CRC"));
  CHECK(Rows(folder / "bag/bag_0.db3", "SELECT COUNT(*), MIN(timestamp) FROM messages") ==
        std::vector<std::string>{"3|30"});
  const YAML::Node bag =
      YAML::Load(*ReadFile(folder / "bag/metadata.yaml"))["rosbag2_bagfile_information"];
  CHECK(bag["message_count"].as<int>() == 3);
  CHECK(bag["starting_time"]["nanoseconds_since_epoch"].as<int>() == 30);
}

TEST_CASE("A recording without messages is a whole file, and becomes a folder without messages",
          "[operator][bag]") {
  const test::TemporaryFolder folder;
  McapWriter writer = MustCreate(folder / "a.mcap");
  writer.AddChannel(TextSchema(), TextChannel("/a"));
  REQUIRE(writer.Finish());
  McapReader reader = MustOpen(folder / "a.mcap");
  CHECK(reader.cut_off().empty());
  CHECK(reader.topics().empty());
  CHECK(AllMessages(reader).empty());
  REQUIRE(WriteRosbag2(reader, folder / "bag/", [](std::uint64_t) {}));
  CHECK(Rows(folder / "bag/bag_0.db3", "SELECT count(*) FROM messages") ==
        std::vector<std::string>{"0"});
}

/// A recording at `path` of `count` equal messages.
void WriteMany(const std::filesystem::path& path, int count, const Bytes& message) {
  McapWriter writer = MustCreate(path);
  const auto channel = writer.AddChannel(TextSchema(), TextChannel("/a"));
  for (int i = 0; i < count; ++i) REQUIRE(writer.Write(channel, 1, 1, message));
  REQUIRE(writer.Finish());
}

/// Of the export of a.mcap to the folder "bag".
Error ExportError(const test::TemporaryFolder& folder) {
  McapReader reader = MustOpen(folder / "a.mcap");
  const auto written = WriteRosbag2(reader, folder / "bag", [](std::uint64_t) {});
  REQUIRE_FALSE(written);
  return written.error();
}

TEST_CASE("A folder that exists is left alone", "[operator][bag]") {
  const test::TemporaryFolder folder;
  WriteSmallRecording(folder / "a.mcap");
  std::filesystem::create_directory(folder / "bag");
  CHECK(ExportError(folder).code == ErrorCode::kRefused);
  CHECK(std::filesystem::is_empty(folder / "bag"));
}

TEST_CASE("A channel that rosbag2 does not know, and a full disk, are named and leave nothing",
          "[operator][bag]") {
  const test::TemporaryFolder folder;
  SECTION("a channel") {
    McapWriter writer = MustCreate(folder / "a.mcap");
    const auto json = writer.AddChannel({0, "Text", "jsonschema", "{}"}, {0, 0, "/a", "json", {}});
    REQUIRE(writer.Write(json, 1, 1, TextMessage("")));
    REQUIRE(writer.Finish());
    CHECK_THAT(ExportError(folder).text, Catch::Contains("topic /a: "));
  }
  SECTION("a full disk") {
    WriteMany(folder / "a.mcap", 100, TextMessage(std::string(10'000, 'x')));
    const test::FullDisk disk(50'000);
    const Error error = ExportError(folder);
    CHECK(error.code == ErrorCode::kIo);
    CHECK_THAT(error.text, Catch::Contains("bag_0.db3: "));
  }
  CHECK_FALSE(std::filesystem::exists(folder / "bag"));
}

TEST_CASE("Progress is reported during the export", "[operator][bag]") {
  const test::TemporaryFolder folder;
  WriteMany(folder / "a.mcap", 2500, TextMessage(""));
  McapReader reader = MustOpen(folder / "a.mcap");
  std::vector<std::uint64_t> reported;
  REQUIRE(
      WriteRosbag2(reader, folder / "bag", [&](std::uint64_t done) { reported.push_back(done); }));
  CHECK(reported == std::vector<std::uint64_t>{1000, 2000});
}

}  // namespace
}  // namespace conav::bag
