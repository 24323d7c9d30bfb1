#include "operator/bag/mcap_contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "operator/bag/chunk_codec.h"
#include "operator/bag/mcap_scan.h"

namespace conav::bag {
namespace {

constexpr std::uint64_t kLargestSummary = std::uint64_t{256} << 20;
constexpr std::size_t kEndSize = kRecordHeaderSize + kFooterSize + kMagicSize;
constexpr std::size_t kFooterCrcSize = 4;

bool IsMagic(ByteSpan bytes) {
  return std::equal(bytes.begin(), bytes.end(), std::begin(kMagic), std::end(kMagic));
}

Result<void> CheckMagic(const InputFile& file) {
  if (file.size() >= kMagicSize) {
    const auto begin = file.Read(0, kMagicSize);
    if (!begin) return tl::unexpected(begin.error());
    if (IsMagic(*begin)) return {};
  }
  return Fail(ErrorCode::kMalformed,
              fmt::format("{}: no MCAP file: it does not begin like one", file.path().string()));
}

/// Footer, end magic and what they say is in between; nothing when the file has no end.
struct Summary {
  Bytes bytes;
  std::uint64_t offset = 0;
};
Result<std::optional<Summary>> ReadSummary(const InputFile& file) {
  if (file.size() < kMagicSize + kEndSize) return std::nullopt;
  const std::uint64_t footer_at = file.size() - kEndSize;
  const auto end = file.Read(footer_at, kEndSize);
  if (!end) return tl::unexpected(end.error());
  if (!IsMagic(ByteSpan(*end).last(kMagicSize))) return std::nullopt;
  ByteSpan rest = *end;
  const auto record = TakeRecord(rest);
  const auto footer =
      record && record->opcode == Opcode::kFooter ? ReadFooter(record->content) : std::nullopt;
  if (!footer) return DamagedAt(file, footer_at, "the footer is damaged");
  if (footer->summary_start == 0) return Summary{{}, footer_at};
  if (footer->summary_start < kMagicSize || footer->summary_start > footer_at) {
    return DamagedAt(file, footer_at,
                     fmt::format("the summary cannot begin at byte {}", footer->summary_start));
  }
  const std::uint64_t size = footer_at - footer->summary_start;
  if (size > kLargestSummary) {
    return DamagedAt(file, footer_at,
                     fmt::format("a summary of {} bytes; {} is the limit", size, kLargestSummary),
                     ErrorCode::kRefused);
  }
  auto bytes = file.Read(footer->summary_start, size);
  if (!bytes) return tl::unexpected(bytes.error());
  const std::size_t covered = kRecordHeaderSize + kFooterSize - kFooterCrcSize;
  const std::uint32_t crc = Crc32(ByteSpan(*end).first(covered), Crc32(*bytes));
  if (footer->summary_crc != 0 && footer->summary_crc != crc) {
    return DamagedAt(file, footer->summary_start, "the CRC of the summary is wrong");
  }
  return Summary{*std::move(bytes), footer->summary_start};
}

Result<void> ReadMetadataAt(const InputFile& file, const MetadataIndex& index,
                            McapContents& contents) {
  const auto bytes = file.Read(index.offset, index.length);
  if (!bytes) return tl::unexpected(bytes.error());
  ByteSpan rest = *bytes;
  const auto record = TakeRecord(rest);
  auto metadata =
      record && record->opcode == Opcode::kMetadata ? ReadMetadata(record->content) : std::nullopt;
  if (!metadata) return DamagedAt(file, index.offset, "no metadata record");
  contents.metadata.push_back(*std::move(metadata));
  return {};
}

/// Whether the summary tells everything that the data section does.
bool IsEnough(const McapContents& contents, bool has_statistics) {
  const Statistics& statistics = contents.statistics;
  return has_statistics && statistics.chunk_count == contents.chunks.size() &&
         statistics.channel_count == contents.channels.size() &&
         (statistics.message_count == 0 || statistics.chunk_count > 0);
}

/// Nothing when the summary leaves something out.
Result<std::optional<McapContents>> ParseSummary(const InputFile& file, const Summary& summary) {
  McapContents contents;
  bool has_statistics = false;
  ByteSpan rest = summary.bytes;
  while (!rest.empty()) {
    const std::uint64_t at = summary.offset + (summary.bytes.size() - rest.size());
    const auto record = TakeRecord(rest);
    if (!record) return DamagedAt(file, at, "the summary ends within a record");
    bool good = true;
    if (record->opcode == Opcode::kSchema || record->opcode == Opcode::kChannel) {
      good = AddDescription(*record, contents);
    } else if (record->opcode == Opcode::kChunkIndex) {
      auto index = ReadChunkIndex(record->content);
      good = index.has_value();
      if (index) contents.chunks.push_back(*std::move(index));
    } else if (record->opcode == Opcode::kStatistics) {
      auto statistics = ReadStatistics(record->content);
      good = has_statistics = statistics.has_value();
      if (statistics) contents.statistics = *std::move(statistics);
    } else if (record->opcode == Opcode::kMetadataIndex) {
      const auto index = ReadMetadataIndex(record->content);
      good = index.has_value();
      if (index) {
        if (auto read = ReadMetadataAt(file, *index, contents); !read) {
          return tl::unexpected(read.error());
        }
      }
    }
    if (!good) return DamagedAt(file, at, "a record of the summary is damaged");
  }
  if (!IsEnough(contents, has_statistics)) return std::nullopt;
  return contents;
}

Result<void> CheckReferences(const InputFile& file, const McapContents& contents) {
  for (const auto& [id, channel] : contents.channels) {
    if (channel.schema_id == 0 || contents.schemas.contains(channel.schema_id)) continue;
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: topic {} has schema {}, which is not there", file.path().string(),
                            channel.topic, channel.schema_id));
  }
  return {};
}

Result<McapContents> ReadAny(const InputFile& file) {
  const auto summary = ReadSummary(file);
  if (!summary) return tl::unexpected(summary.error());
  if (*summary) {
    auto contents = ParseSummary(file, **summary);
    if (!contents) return tl::unexpected(contents.error());
    if (*contents) return **std::move(contents);
  }
  auto scanned = ScanContents(file);
  // What the scan does not look at is the end.
  if (scanned && *summary) scanned->cut_off.clear();
  return scanned;
}

}  // namespace

tl::unexpected<Error> DamagedAt(const InputFile& file, std::uint64_t offset,
                                const std::string& what, ErrorCode code) {
  return Fail(code, fmt::format("{}: at byte {}: {}", file.path().string(), offset, what));
}

Result<Bytes> ReadChunkAt(const InputFile& file, std::uint64_t offset, std::uint64_t length) {
  if (length > kLargestChunk) {
    return DamagedAt(file, offset,
                     fmt::format("a chunk of {} bytes; {} is the limit", length, kLargestChunk),
                     ErrorCode::kRefused);
  }
  const auto bytes = file.Read(offset, length);
  if (!bytes) return tl::unexpected(bytes.error());
  ByteSpan rest = *bytes;
  const auto record = TakeRecord(rest);
  const auto chunk =
      record && record->opcode == Opcode::kChunk ? ReadChunk(record->content) : std::nullopt;
  if (!chunk) return DamagedAt(file, offset, "no chunk, or a damaged one");
  auto unpacked = Unpack(*chunk);
  if (unpacked) return unpacked;
  return DamagedAt(file, offset, "chunk: " + unpacked.error().text, unpacked.error().code);
}

Result<McapContents> ReadContents(const InputFile& file) {
  if (auto magic = CheckMagic(file); !magic) return tl::unexpected(magic.error());
  auto contents = ReadAny(file);
  if (!contents) return contents;
  return CheckReferences(file, *contents).map([&] { return *std::move(contents); });
}

}  // namespace conav::bag
