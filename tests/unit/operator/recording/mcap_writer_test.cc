#include "operator/recording/mcap_file.h"
#include "support/full_disk.h"
#include "unit/operator/recording/recordings.h"

namespace conav::bag {
namespace {

std::vector<std::uint64_t> LogTimes(McapReader& reader) {
  std::vector<std::uint64_t> times;
  for (const RecordedMessage& message : AllMessages(reader)) times.push_back(message.log_time);
  return times;
}

TEST_CASE("A written file is read again, and not overwritten", "[operator][bag]") {
  const test::TemporaryFolder folder;
  WriteSmallRecording(folder / "a.mcap");
  McapReader reader = MustOpen(folder / "a.mcap");
  CHECK(reader.cut_off().empty());
  CHECK(reader.message_count() == 5);
  CHECK(reader.start_time() == 10);
  CHECK(reader.end_time() == 50);
  REQUIRE(reader.metadata().size() == 1);
  CHECK(reader.metadata()[0].name == "conav");
  CHECK(reader.metadata()[0].values == TextMap{{"version", "1.2"}});
  REQUIRE(reader.topics().size() == 2);
  const RecordedTopic& b = reader.topics()[1];
  CHECK(b.channel.topic == "/b");
  CHECK(b.channel.message_encoding == "cdr");
  CHECK(b.channel.metadata == TextChannel("").metadata);
  CHECK(b.schema.name == "std_msgs/msg/String");
  CHECK(b.schema.encoding == "ros2msg");
  CHECK(b.schema.text == "string data\n");
  CHECK(b.message_count == 2);
  const auto messages = AllMessages(reader);
  REQUIRE(messages.size() == 5);
  const RecordedMessage& last = messages[4];
  CHECK(last.topic == &b);
  CHECK(last.sequence == 2);
  CHECK(last.log_time == 50);
  CHECK(last.publish_time == 5);
  CHECK(Bytes(last.data.begin(), last.data.end()) == TextMessage("five"));
  const Bytes before = BytesOf(folder / "a.mcap");
  const auto again = McapWriter::Create(folder / "a.mcap", {}, {});
  REQUIRE_FALSE(again);
  CHECK(again.error().code == ErrorCode::kIo);
  CHECK_THAT(again.error().text, Catch::Contains("a.mcap: "));
  CHECK(BytesOf(folder / "a.mcap") == before);
}

TEST_CASE("A chunk is written when it is full", "[operator][bag]") {
  const test::TemporaryFolder folder;
  McapWriter writer = MustCreate(folder / "a.mcap", {.chunk_bytes = 1000});
  const auto channel = writer.AddChannel(TextSchema(), TextChannel("/a"));
  const std::uint64_t before = writer.file_size();
  REQUIRE(writer.Write(channel, 1, 1, TextMessage(std::string(100, 'x'))));
  CHECK(writer.pending() == 1);
  CHECK(writer.file_size() == before);
  REQUIRE(writer.Write(channel, 2, 2, TextMessage(std::string(1000, 'x'))));
  CHECK(writer.pending() == 0);
  CHECK(writer.message_count() == 2);
  CHECK(writer.file_size() > before);
}

TEST_CASE("Messages that are logged out of order are read in order", "[operator][bag]") {
  const test::TemporaryFolder folder;
  McapWriter writer = MustCreate(folder / "a.mcap");
  const auto a = writer.AddChannel(TextSchema(), TextChannel("/a"));
  for (const std::uint64_t time : {30, 10, 50}) REQUIRE(writer.Write(a, time, 0, TextMessage("")));
  REQUIRE(writer.Flush());
  for (const std::uint64_t time : {40, 20, 10}) REQUIRE(writer.Write(a, time, 0, TextMessage("")));
  REQUIRE(writer.Finish());
  McapReader reader = MustOpen(folder / "a.mcap");
  CHECK(LogTimes(reader) == std::vector<std::uint64_t>{10, 10, 20, 30, 40, 50});
}

TEST_CASE("On a full disk the file keeps what it has, and goes on when there is room again",
          "[operator][bag]") {
  const test::TemporaryFolder folder;
  McapWriter writer = MustCreate(folder / "a.mcap");
  const auto a = writer.AddChannel(TextSchema(), TextChannel("/a"));
  const auto b =
      writer.AddChannel({0, "std_msgs/msg/Other", "ros2msg", "string data\n"}, TextChannel("/b"));
  REQUIRE(writer.Write(a, 10, 0, TextMessage("kept")));
  REQUIRE(writer.Flush());
  {
    const test::FullDisk disk(writer.file_size() + 20);
    REQUIRE(writer.Write(b, 20, 0, TextMessage("lost")));
    const auto flushed = writer.Flush();
    REQUIRE_FALSE(flushed);
    CHECK(flushed.error().code == ErrorCode::kIo);
    CHECK_THAT(flushed.error().text, Catch::Contains("a.mcap: "));
  }
  CHECK(writer.lost() == 1);
  CHECK(writer.message_count() == 1);
  {
    McapReader reader = MustOpen(folder / "a.mcap");
    CHECK_THAT(reader.cut_off(), Catch::Contains("not finished"));
    CHECK(LogTimes(reader) == std::vector<std::uint64_t>{10});
  }
  // The schema and channel that were lost come again.
  REQUIRE(writer.Write(b, 30, 0, TextMessage("kept")));
  REQUIRE(writer.Flush());
  {
    const test::FullDisk disk(writer.file_size() + 20);
    REQUIRE_FALSE(writer.Finish());  // without room for the summary
    CHECK(MustOpen(folder / "a.mcap").message_count() == 2);
  }
  REQUIRE(writer.Finish());
  McapReader reader = MustOpen(folder / "a.mcap");
  CHECK_THAT(reader.cut_off(), Catch::StartsWith("messages lost: 1 "));
  CHECK(reader.topics().size() == 2);
  CHECK(LogTimes(reader) == std::vector<std::uint64_t>{10, 30});
}

}  // namespace
}  // namespace conav::bag
