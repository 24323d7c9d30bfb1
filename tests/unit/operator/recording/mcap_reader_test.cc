#include <fmt/core.h>

#include "operator/recording/mcap_file.h"
#include "unit/operator/recording/recordings.h"

namespace conav::bag {
namespace {

/// The error of the first thing that fails: to open the file or to read all of it.
Error ErrorOf(const std::filesystem::path& path) {
  auto reader = McapReader::Open(path);
  while (reader) {
    const auto next = reader->Next();
    if (!next) return next.error();
    REQUIRE(*next);
  }
  return reader.error();
}

/// The small recording, to be damaged.
struct Damaged {
  Damaged() {
    WriteSmallRecording(folder / "a.mcap");
    bytes = BytesOf(folder / "a.mcap");
  }
  std::size_t Find(Opcode opcode, int number = 1) const { return PlaceOf(bytes, opcode, number); }
  std::filesystem::path Stored() {
    Store(folder / "b.mcap", bytes);
    return folder / "b.mcap";
  }
  /// Makes its CRC wrong, or right again.
  void BreakChunk(int number) { bytes[Find(Opcode::kChunk, number) + kRecordHeaderSize + 24] ^= 1; }
  void CutBefore(Opcode opcode) { bytes.resize(Find(opcode)); }

  test::TemporaryFolder folder;
  Bytes bytes;
};

TEST_CASE("Seek goes on at a log time, back and forth, and a message lives on without its reader",
          "[operator][bag]") {
  const test::TemporaryFolder folder;
  WriteSmallRecording(folder / "a.mcap");
  RecordedMessage kept;
  {
    McapReader reader = MustOpen(folder / "a.mcap");
    for (const auto& [time, first] : {std::pair(31U, 40U), {30U, 30U}, {0U, 10U}}) {
      reader.Seek(time);
      kept = AllMessages(reader).at(0);
      CHECK(kept.log_time == first);
    }
    reader.Seek(51);
    CHECK(AllMessages(reader).empty());
  }
  CHECK(Bytes(kept.data.begin(), kept.data.end()) == TextMessage("one"));
}

TEST_CASE("A recording that goes on in further files is read as one, and says what is missing",
          "[operator][bag]") {
  const test::TemporaryFolder folder;
  const auto write = [&](const std::string& name, const std::string& follows, std::uint64_t time,
                         std::uint64_t lost) {
    auto writer =
        McapWriter::Create(folder / name, {}, {{kFactsName, {{kFollowsFact, follows}}}}).value();
    if (time == 20) writer.AddChannel(TextSchema(), TextChannel("/b"));  // other ids in each file
    const auto a = writer.AddChannel(TextSchema(), TextChannel("/a"));
    for (const std::uint64_t at : {time, time + 1}) {
      REQUIRE(writer.Write(a, at * 1'000'000'000, 0, TextMessage(name)));
    }
    writer.NoteLost(lost);
    REQUIRE((time == 10 ? writer.Flush() : writer.Finish()));  // the first recorder was killed
  };
  write("recording.mcap", "", 10, 0);
  write("recording-2.mcap", "recording.mcap", 20, 0);
  Store(folder / "recording-3.mcap", TextMessage("a recorder that was killed before it wrote"));
  write("recording-4.mcap", "recording-3.mcap", 30, 7);
  write("recording-5.mcap", "another.mcap", 40, 0);

  McapReader reader = MustOpen(RecordingOf(folder.path()).value());
  CHECK(reader.files() == 3);
  CHECK(reader.message_count() == 6);
  CHECK(reader.start_time() == 10'000'000'000);
  CHECK(reader.end_time() == 31'000'000'000);
  CHECK_THAT(reader.cut_off(), Catch::Contains("not finished") &&
                                   Catch::Contains("recording-2.mcap begins 9.0 s later") &&
                                   Catch::Contains("recording-3.mcap") &&
                                   Catch::Contains("recording-4.mcap: messages lost: 7"));
  REQUIRE(reader.topics().size() == 2);
  CHECK(reader.topics()[0].message_count == 6);
  for (const auto& message : AllMessages(reader)) CHECK(message.topic == &reader.topics()[0]);
  reader.Seek(21'000'000'000);
  CHECK(AllMessages(reader).size() == 3);
  std::filesystem::remove(folder / "recording.mcap");
  CHECK(MustOpen(RecordingOf(folder.path()).value()).message_count() == 4);
}

// The faults report's S14: "235 kB MCAP -> 3.4 GB and `terminate ... std::bad_alloc`, exit 134: chunks
// whose times overlap are all unpacked at once".
TEST_CASE("Chunks that overlap in time are unpacked up to a limit, the others are read",
          "[operator][bag]") {
  constexpr std::size_t kSize = 100'000;
  constexpr int kChunks = 20;
  const test::TemporaryFolder folder;
  McapWriter writer = MustCreate(folder / "a.mcap");
  const auto topic = writer.AddChannel(TextSchema(), TextChannel("/a"));
  for (std::uint64_t i = 0; i < kChunks; ++i) {
    REQUIRE(writer.Write(topic, i, i, Bytes(kSize)));
    REQUIRE(writer.Write(topic, 1000 + i, i, Bytes(kSize)));
    REQUIRE(writer.Flush());
  }
  REQUIRE(writer.Finish());
  CHECK(std::filesystem::file_size(folder / "a.mcap") < kSize);
  const auto count = [&](std::uint64_t limit) {
    auto reader = McapReader::Open(folder / "a.mcap", limit).value();
    std::pair<int, int> read_and_refused;
    for (;;) {
      const auto next = reader.Next();
      if (!next) {
        CHECK(next.error().code == ErrorCode::kRefused);
        ++read_and_refused.second;
      } else if (!*next) {
        return read_and_refused;
      } else {
        ++read_and_refused.first;
      }
    }
  };
  CHECK(count(kReadLimit) == std::pair(2 * kChunks, 0));
  CHECK(count(5 * kSize) == std::pair(2 * 2, kChunks - 2));
}

TEST_CASE("A file cut off at any byte is read up to its last whole chunk, or refused by name",
          "[operator][bag]") {
  Damaged file;
  const std::size_t first_end = file.Find(Opcode::kMessageIndex, 1);
  const std::size_t second_end = file.Find(Opcode::kMessageIndex, 3);
  const Bytes whole = file.bytes;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    Store(file.folder / "b.mcap", ByteSpan(whole).first(size));
    auto reader = McapReader::Open(file.folder / "b.mcap");
    if (size < kMagicSize) {
      REQUIRE_FALSE(reader);
      CHECK_THAT(reader.error().text, Catch::Contains("b.mcap: "));
      continue;
    }
    REQUIRE(reader);
    CHECK_THAT(reader->cut_off(), Catch::Contains("not finished"));
    const std::size_t expected = size >= second_end ? 5U : size >= first_end ? 2U : 0U;
    CHECK(reader->message_count() == expected);
    CHECK(AllMessages(*reader).size() == expected);
  }
}

TEST_CASE("A file with any byte changed is read or refused, never worse", "[operator][bag]") {
  Damaged file;
  const Bytes whole = file.bytes;
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const auto flip : {std::uint8_t{0x01}, std::uint8_t{0x80}, std::uint8_t{0xFF}}) {
      file.bytes = whole;
      file.bytes[at] ^= flip;
      auto reader = McapReader::Open(file.Stored());
      bool good = reader.has_value();
      while (good) {
        const auto next = reader->Next();
        good = next && *next;
        if (!next) ++refused;
      }
      if (!reader) {
        ++refused;
        CHECK_THAT(reader.error().text, Catch::Contains("b.mcap: "));
      }
    }
  }
  CHECK(refused > static_cast<int>(whole.size()));
}

TEST_CASE("Damage is refused by its place, an absurd length takes no memory", "[operator][bag]") {
  struct Row {
    Opcode record;
    std::size_t byte;  // of its content
    std::uint8_t value;
    ErrorCode code;
    const char* names;
  };
  for (const Row& row : std::vector<Row>{
           // start, end, size, then the CRC
           {Opcode::kChunk, 24, 0x01, ErrorCode::kMalformed, "at byte {}: "},
           {Opcode::kChunk, 16 + 5, 0x7F, ErrorCode::kRefused, "268435456"},
           {Opcode::kStatistics, 0, 0x01, ErrorCode::kMalformed, "summary"},
           {Opcode::kFooter, 7, 0x7F, ErrorCode::kMalformed, "at byte {}: "},
       }) {
    CAPTURE(row.record, row.byte);
    Damaged file;
    const std::size_t at = file.Find(row.record);
    file.bytes[at + kRecordHeaderSize + row.byte] ^= row.value;
    const Error error = ErrorOf(file.Stored());
    CHECK(error.code == row.code);
    CHECK_THAT(error.text, Catch::Contains(fmt::format(fmt::runtime(row.names), at)));
  }
}

TEST_CASE("Damaged chunks are left out, the others are read", "[operator][bag]") {
  Damaged finished;
  finished.BreakChunk(1);
  McapReader after = MustOpen(finished.Stored());
  REQUIRE_FALSE(after.Next());
  CHECK(AllMessages(after).size() == 3);
  Damaged file;
  file.CutBefore(Opcode::kDataEnd);
  file.BreakChunk(2);
  McapReader reader = MustOpen(file.Stored());
  CHECK(AllMessages(reader).size() == 2);
  CHECK_THAT(reader.cut_off(), Catch::Contains("1 damaged"));

  file.BreakChunk(2);
  file.BreakChunk(1);  // which describes the topics
  McapReader rest = MustOpen(file.Stored());
  CHECK(rest.message_count() == AllMessages(rest).size());
  CHECK_THAT(rest.cut_off(), Catch::Contains("not described"));
}

TEST_CASE("Zeros that a loss of power leaves end what is read", "[operator][bag]") {
  Damaged file;
  file.CutBefore(Opcode::kDataEnd);
  file.bytes.resize(file.bytes.size() + 100'000);
  file.bytes.back() = 1;
  CHECK(MustOpen(file.Stored()).message_count() == 5);
  // From within the last chunk on.
  file.bytes.resize(file.Find(Opcode::kChunk, 2) + kRecordHeaderSize + 50);
  file.bytes.resize(100'000);
  McapReader reader = MustOpen(file.Stored());
  CHECK(AllMessages(reader).size() == 2);
  CHECK_THAT(reader.cut_off(), Catch::Contains("up to byte"));
}

/// A file by somebody else: what comes before the footer, without summary.
Bytes ForeignFile(const std::function<void(Bytes&)>& append) {
  Bytes bytes(std::begin(kMagic), std::end(kMagic));
  Append(bytes, Header{});
  append(bytes);
  Append(bytes, DataEnd{});
  Append(bytes, Footer{});
  bytes.insert(bytes.end(), std::begin(kMagic), std::end(kMagic));
  return bytes;
}

Bytes OneMessage() {
  Bytes records;
  Append(records, Channel{7, 0, "/a", "json", {}});
  Append(records, MessageHeader{7, 1, 10, 10}, TextMessage("x"));
  return records;
}

TEST_CASE("A finished file without a summary, without compression and without CRCs is read",
          "[operator][bag]") {
  const test::TemporaryFolder folder;
  const Bytes records = OneMessage();
  Store(folder / "a.mcap", ForeignFile([&](Bytes& out) {
          Append(out, ChunkHeader{10, 10, records.size(), 0, ""}, records);
        }));
  McapReader reader = MustOpen(folder / "a.mcap");
  CHECK(reader.cut_off().empty());
  REQUIRE(reader.topics().size() == 1);
  CHECK(reader.topics()[0].schema.name.empty());
  CHECK(AllMessages(reader).size() == 1);
}

TEST_CASE("Files of another kind, and features of MCAP that are not supported, are refused by name",
          "[operator][bag]") {
  const test::TemporaryFolder folder;
  Bytes orphan;
  Append(orphan, Channel{7, 3, "/a", "cdr", {}});
  struct Row {
    const char* names;
    std::function<void(Bytes&)> append;
  };
  for (const Row& row : std::vector<Row>{
           {"lz4",
            [](Bytes& out) {
              Append(out, ChunkHeader{0, 0, 10, 0, "lz4"}, TextMessage(""));
            }},
           {"chunk",
            [](Bytes& out) {
              const Bytes records = OneMessage();
              out.insert(out.end(), records.begin(), records.end());
            }},
           {"schema 3",
            [&](Bytes& out) {
              Append(out, ChunkHeader{0, 0, orphan.size(), Crc32(orphan), ""}, orphan);
            }},
       }) {
    Store(folder / "a.mcap", ForeignFile(row.append));
    CHECK_THAT(ErrorOf(folder / "a.mcap").text, Catch::Contains(row.names));
  }
  const test::TemporaryFolder others;
  Store(others / "a.mcap", TextMessage("something else, as long as a header"));
  CHECK(ErrorOf(others / "a.mcap").code == ErrorCode::kMalformed);
  CHECK(ErrorOf(others / "none.mcap").code == ErrorCode::kNotFound);
  CHECK_THAT(ErrorOf(others / "none.mcap").text, Catch::Contains("none.mcap"));
  CHECK(ErrorOf(others.path()).code == ErrorCode::kIo);
}

}  // namespace
}  // namespace conav::bag
