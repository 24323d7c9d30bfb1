#include "operator/recording/mcap_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "operator/recording/mcap_records.h"
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
  std::size_t Find(Opcode opcode, int number = 1) const {
    ByteSpan rest = bytes;
    rest = rest.subspan(kMagicSize);
    for (;;) {
      const std::size_t at = bytes.size() - rest.size();
      const auto record = TakeRecord(rest);
      REQUIRE(record);
      if (record->opcode == opcode && --number == 0) return at;
    }
  }
  std::filesystem::path Stored() {
    Store(folder / "b.mcap", bytes);
    return folder / "b.mcap";
  }
  void CutBefore(Opcode opcode) { bytes.resize(Find(opcode)); }

  test::TemporaryFolder folder;
  Bytes bytes;
};

TEST_CASE("Seek goes on at a log time, back and forth", "[operator][bag]") {
  const test::TemporaryFolder folder;
  WriteSmallRecording(folder / "a.mcap");
  McapReader reader = MustOpen(folder / "a.mcap");
  const auto first_from = [&](std::uint64_t time) {
    reader.Seek(time);
    return AllMessages(reader).at(0).log_time;
  };
  CHECK(first_from(31) == 40);
  CHECK(first_from(30) == 30);
  CHECK(first_from(0) == 10);
  reader.Seek(51);
  CHECK(AllMessages(reader).empty());
}

TEST_CASE("A message lives on without its reader", "[operator][bag]") {
  const test::TemporaryFolder folder;
  WriteSmallRecording(folder / "a.mcap");
  RecordedMessage kept;
  {
    McapReader reader = MustOpen(folder / "a.mcap");
    kept = AllMessages(reader).at(0);
  }
  CHECK(Bytes(kept.data.begin(), kept.data.end()) == TextMessage("one"));
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
      CHECK_THAT(reader.error().text, Catch::Contains("b.mcap: no MCAP file"));
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

TEST_CASE("What is no MCAP file is refused", "[operator][bag]") {
  const test::TemporaryFolder folder;
  Store(folder / "a.mcap", TextMessage("something else, as long as a header"));
  CHECK(ErrorOf(folder / "a.mcap").code == ErrorCode::kMalformed);
  CHECK(ErrorOf(folder / "none.mcap").code == ErrorCode::kNotFound);
  CHECK_THAT(ErrorOf(folder / "none.mcap").text, Catch::Contains("none.mcap: No such file"));
  CHECK(ErrorOf(folder.path()).code == ErrorCode::kIo);
}

TEST_CASE("A chunk with a wrong CRC is refused, with its place", "[operator][bag]") {
  Damaged file;
  const std::size_t chunk = file.Find(Opcode::kChunk);
  file.bytes[chunk + kRecordHeaderSize + 24] ^= 1;  // start, end, size, then the CRC
  const Error error = ErrorOf(file.Stored());
  CHECK(error.code == ErrorCode::kMalformed);
  CHECK_THAT(error.text,
             Catch::Contains(fmt::format("at byte {}: chunk: the CRC is wrong", chunk)));
}

TEST_CASE("What is behind a damaged chunk can still be read", "[operator][bag]") {
  Damaged file;
  file.bytes[file.Find(Opcode::kChunk) + kRecordHeaderSize + 24] ^= 1;
  McapReader reader = MustOpen(file.Stored());
  REQUIRE_FALSE(reader.Next());
  CHECK(AllMessages(reader).size() == 3);
}

TEST_CASE("A summary with a wrong CRC is refused", "[operator][bag]") {
  Damaged file;
  file.bytes[file.Find(Opcode::kStatistics) + kRecordHeaderSize] ^= 1;
  CHECK_THAT(ErrorOf(file.Stored()).text, Catch::Contains("the CRC of the summary is wrong"));
}

TEST_CASE("A damaged footer is refused", "[operator][bag]") {
  Damaged file;
  const std::size_t footer = file.Find(Opcode::kFooter);
  file.bytes[footer + kRecordHeaderSize + 7] = 0x7F;  // the summary begins far behind the end
  CHECK_THAT(ErrorOf(file.Stored()).text, Catch::Contains("the summary cannot begin at byte"));
}

TEST_CASE("An absurd length takes no memory", "[operator][bag]") {
  Damaged file;
  const std::size_t chunk = file.Find(Opcode::kChunk);
  file.bytes[chunk + kRecordHeaderSize + 16 + 5] = 0x7F;  // uncompressed size: 2^46 bytes and more
  const Error error = ErrorOf(file.Stored());
  CHECK(error.code == ErrorCode::kRefused);
  CHECK_THAT(error.text, Catch::Contains("bytes unpacked; 268435456 is the limit"));
}

TEST_CASE("Damaged chunks of an unfinished file are left out, the others are read",
          "[operator][bag]") {
  Damaged file;
  file.CutBefore(Opcode::kDataEnd);
  const std::size_t first = file.Find(Opcode::kChunk, 1);
  const std::size_t second = file.Find(Opcode::kChunk, 2);
  file.bytes[second + kRecordHeaderSize + 24] ^= 1;
  McapReader reader = MustOpen(file.Stored());
  CHECK(AllMessages(reader).size() == 2);
  CHECK_THAT(reader.cut_off(), Catch::Contains("1 damaged chunks are left out"));

  file.bytes[second + kRecordHeaderSize + 24] ^= 1;
  file.bytes[first + kRecordHeaderSize + 24] ^= 1;  // which describes the topics
  McapReader rest = MustOpen(file.Stored());
  CHECK(rest.message_count() == AllMessages(rest).size());
  CHECK_THAT(rest.cut_off(), Catch::Contains("topics that are not described are left out"));
}

TEST_CASE("A loss of power that leaves zeros from within the last chunk on", "[operator][bag]") {
  Damaged file;
  file.CutBefore(Opcode::kDataEnd);
  const std::size_t size = file.bytes.size();
  file.bytes.resize(file.Find(Opcode::kChunk, 2) + kRecordHeaderSize + 50);
  file.bytes.resize(size + 100'000);
  McapReader reader = MustOpen(file.Stored());
  CHECK(AllMessages(reader).size() == 2);
  CHECK_THAT(reader.cut_off(), Catch::Contains("it is whole up to byte"));
}

TEST_CASE("What is behind zeros in an unfinished file is not read", "[operator][bag]") {
  Damaged file;
  file.CutBefore(Opcode::kDataEnd);
  file.bytes.resize(file.bytes.size() + 100'000);
  file.bytes.back() = 1;
  McapReader reader = MustOpen(file.Stored());
  CHECK(reader.message_count() == 5);
}

/// A file by somebody else: what comes before the footer, without summary.
Bytes ForeignFile(const std::function<void(Bytes&)>& append) {
  Bytes bytes(std::begin(kMagic), std::end(kMagic));
  AppendHeader(bytes, "", "");
  append(bytes);
  AppendDataEnd(bytes, 0);
  AppendFooterBegin(bytes, {});
  AppendFooterCrc(bytes, 0);
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

TEST_CASE("What is not read here is refused by name", "[operator][bag]") {
  const test::TemporaryFolder folder;
  Store(folder / "lz4.mcap", ForeignFile([](Bytes& out) {
          Append(out, ChunkHeader{0, 0, 10, 0, "lz4"}, TextMessage(""));
        }));
  CHECK_THAT(ErrorOf(folder / "lz4.mcap").text, Catch::Contains("compressed with 'lz4'"));
  Store(folder / "flat.mcap", ForeignFile([](Bytes& out) {
          const Bytes records = OneMessage();
          out.insert(out.end(), records.begin(), records.end());
        }));
  CHECK_THAT(ErrorOf(folder / "flat.mcap").text, Catch::Contains("a message outside of chunks"));
}

TEST_CASE("A topic whose schema is not there is refused", "[operator][bag]") {
  const test::TemporaryFolder folder;
  Bytes records;
  Append(records, Channel{7, 3, "/a", "cdr", {}});
  Store(folder / "a.mcap", ForeignFile([&](Bytes& out) {
          Append(out, ChunkHeader{0, 0, records.size(), Crc32(records), ""}, records);
        }));
  CHECK_THAT(ErrorOf(folder / "a.mcap").text,
             Catch::Contains("topic /a has schema 3, which is not there"));
}

}  // namespace
}  // namespace conav::bag
