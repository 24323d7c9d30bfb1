#include "operator/bag/mcap_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "operator/bag/chunk_codec.h"

namespace conav::bag {
namespace {

class Scan {
 public:
  explicit Scan(const InputFile& file) : file_(file) {}

  Result<McapContents> Run() {
    while (at_ < file_.size() && !ended_) {
      if (auto done = TakeNext(); !done) return tl::unexpected(done.error());
    }
    if (contents_.cut_off.empty()) contents_.cut_off = "the file was not finished: no summary";
    TellLosses();
    contents_.statistics.chunk_count = static_cast<std::uint32_t>(contents_.chunks.size());
    return std::move(contents_);
  }

 private:
  std::uint64_t left() const { return file_.size() - at_; }

  Result<void> EndHere() {
    ended_ = true;
    contents_.cut_off = fmt::format("the file was not finished: it is whole up to byte {} of {}",
                                    at_, file_.size());
    return {};
  }

  void TellLosses() {
    if (damaged_chunks_ > 0) {
      contents_.cut_off += fmt::format("; {} damaged chunks are left out", damaged_chunks_);
    }
    if (unknown_messages_ > 0) {
      contents_.cut_off += fmt::format(
          "; {} messages of topics that are not described are left out", unknown_messages_);
    }
  }

  Result<void> TakeNext() {
    if (left() < kRecordHeaderSize) return EndHere();
    const auto header = file_.Read(at_, kRecordHeaderSize);
    if (!header) return tl::unexpected(header.error());
    ByteReader reader(*header);
    const auto opcode = static_cast<Opcode>(reader.U8());
    const std::uint64_t length = reader.U64();
    // Zeros, which a loss of power can leave, or what is behind a damaged length: no record.
    if (opcode == Opcode{0} || length > left() - kRecordHeaderSize) return EndHere();
    auto done = Take(opcode, kRecordHeaderSize + length);
    at_ += kRecordHeaderSize + length;
    return done;
  }

  Result<void> Take(Opcode opcode, std::uint64_t length) {
    switch (opcode) {
      case Opcode::kChunk:
        return TakeChunk(length);
      case Opcode::kSchema:
      case Opcode::kChannel:
      case Opcode::kMetadata:
        return TakeDescription(length);
      case Opcode::kMessage:
        return DamagedAt(file_, at_, "a message outside of chunks, which is not read here",
                         ErrorCode::kRefused);
      case Opcode::kDataEnd:
      case Opcode::kFooter:
        ended_ = true;
        return {};
      default:
        return {};  // a record that readers may leave out
    }
  }

  Result<void> TakeDescription(std::uint64_t length) {
    if (length > kLargestChunk) {
      return DamagedAt(file_, at_, fmt::format("a record of {} bytes", length),
                       ErrorCode::kRefused);
    }
    const auto bytes = file_.Read(at_, length);
    if (!bytes) return tl::unexpected(bytes.error());
    ByteSpan rest = *bytes;
    const auto record = TakeRecord(rest);
    if (!record || !AddDescription(*record, contents_)) {
      return DamagedAt(file_, at_, "a damaged record");
    }
    return {};
  }

  Result<void> TakeChunk(std::uint64_t length) {
    const auto records = ReadChunkAt(file_, at_, length);
    if (!records && records.error().code != ErrorCode::kMalformed) {
      return tl::unexpected(records.error());
    }
    const Statistics before = contents_.statistics;
    if (!records || !TakeChunkRecords(*records, length)) {
      contents_.statistics = before;
      ++damaged_chunks_;
    }
    return {};
  }

  bool TakeChunkRecords(ByteSpan records, std::uint64_t length) {
    ChunkIndex index{.offset = at_, .length = length};
    bool first = true;
    while (!records.empty()) {
      const auto record = TakeRecord(records);
      if (!record || !TakeChunkRecord(*record, index, first)) return false;
    }
    contents_.chunks.push_back(std::move(index));
    return true;
  }

  bool TakeChunkRecord(const Record& record, ChunkIndex& index, bool& first) {
    if (record.opcode != Opcode::kMessage) return AddDescription(record, contents_);
    const auto message = ReadMessage(record.content);
    if (!message) return false;
    if (!contents_.channels.contains(message->header.channel_id)) {
      ++unknown_messages_;  // its description was in a chunk that is damaged
      return true;
    }
    const std::uint64_t time = message->header.log_time;
    index.start_time = first ? time : std::min(index.start_time, time);
    index.end_time = std::max(index.end_time, time);
    first = false;
    Statistics& statistics = contents_.statistics;
    statistics.start_time =
        statistics.message_count == 0 ? time : std::min(statistics.start_time, time);
    statistics.end_time = std::max(statistics.end_time, time);
    ++statistics.message_count;
    ++statistics.channel_counts[message->header.channel_id];
    return true;
  }

  const InputFile& file_;
  std::uint64_t at_ = kMagicSize;
  bool ended_ = false;
  std::uint64_t damaged_chunks_ = 0;
  std::uint64_t unknown_messages_ = 0;
  McapContents contents_;
};

}  // namespace

bool AddDescription(const Record& record, McapContents& contents) {
  if (record.opcode == Opcode::kSchema) {
    auto schema = ReadSchema(record.content);
    if (!schema || schema->id == 0) return false;
    contents.schemas.emplace(schema->id, *std::move(schema));
  } else if (record.opcode == Opcode::kChannel) {
    auto channel = ReadChannel(record.content);
    if (!channel) return false;
    contents.channels.emplace(channel->id, *std::move(channel));
  } else if (record.opcode == Opcode::kMetadata) {
    auto metadata = ReadMetadata(record.content);
    if (!metadata) return false;
    contents.metadata.push_back(*std::move(metadata));
  }
  return true;
}

Result<McapContents> ScanContents(const InputFile& file) { return Scan(file).Run(); }

}  // namespace conav::bag
