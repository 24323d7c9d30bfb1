#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "operator/recording/mcap_file.h"

namespace conav::bag {
namespace {

/// "FILE: at byte N: WHAT".
tl::unexpected<Error> DamagedAt(const InputFile& file, std::uint64_t offset,
                                const std::string& what, ErrorCode code = ErrorCode::kMalformed) {
  return Fail(code, fmt::format("{}: at byte {}: {}", file.path().string(), offset, what));
}

/// The records of a chunk. Errors as those of ReadContents, with the place in the file.
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

/// Takes up a schema or channel record; of two with one id the first counts. False when it is
/// damaged.
bool AddDescription(const Record& record, McapContents& contents) {
  const auto add = [](auto description, auto& known) {
    if (description) known.emplace(description->id, *std::move(description));
    return description.has_value();
  };
  if (record.opcode == Opcode::kSchema) {
    const auto schema = Read<Schema>(record.content);
    return schema && schema->id != 0 && add(schema, contents.schemas);
  }
  if (record.opcode == Opcode::kChannel) {
    return add(Read<Channel>(record.content), contents.channels);
  }
  if (record.opcode != Opcode::kMetadata) return true;
  auto metadata = Read<Metadata>(record.content);
  if (metadata) contents.metadata.push_back(*std::move(metadata));
  return metadata.has_value();
}

/// ReadContents without a summary: reads every record of the data section, and unpacks every chunk.
/// A record that the end of the file cuts off and what is no record (zeros, which a loss of power
/// can leave) end the data; chunks that are damaged are left out, and so are messages whose topics
/// were described in these. `cut_off` describes that, and is never empty: the summary is missing at
/// least.
class Scan {
 public:
  explicit Scan(const InputFile& file) : file_(file) {}

  Result<McapContents> Run() {
    while (at_ < file_.size() && !ended_) {
      if (auto done = TakeNext(); !done) return tl::unexpected(done.error());
    }
    if (contents_.cut_off.empty()) contents_.cut_off = "the file was not finished: no summary";
    ReportLosses();
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

  void ReportLosses() {
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
    const auto opcode = static_cast<Opcode>(reader.Take<std::uint8_t>());
    const auto length = reader.Take<std::uint64_t>();
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

constexpr std::uint64_t kLargestSummary = std::uint64_t{256} << 20;
constexpr std::size_t kEndSize = kRecordHeaderSize + kFooterSize + kMagicSize;

/// The record that `bytes` begin with, if it is a T.
template <class T>
std::optional<T> ReadFirst(ByteSpan bytes) {
  const auto record = TakeRecord(bytes);
  return record && record->opcode == T::kOpcode ? Read<T>(record->content) : std::nullopt;
}

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
  const auto footer = ReadFirst<Footer>(*end);
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
  auto metadata = ReadFirst<Metadata>(*bytes);
  if (!metadata) return DamagedAt(file, index.offset, "no metadata record");
  contents.metadata.push_back(*std::move(metadata));
  return {};
}

/// Whether the summary covers the whole data section.
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
      auto index = Read<ChunkIndex>(record->content);
      good = index.has_value();
      if (index) contents.chunks.push_back(*std::move(index));
    } else if (record->opcode == Opcode::kStatistics) {
      auto statistics = Read<Statistics>(record->content);
      good = has_statistics = statistics.has_value();
      if (statistics) contents.statistics = *std::move(statistics);
    } else if (record->opcode == Opcode::kMetadataIndex) {
      const auto index = Read<MetadataIndex>(record->content);
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
  auto scanned = Scan(file).Run();
  // The scan skips only the end.
  if (scanned && *summary) scanned->cut_off.clear();
  return scanned;
}

}  // namespace

Result<McapContents> ReadContents(const InputFile& file) {
  if (auto magic = CheckMagic(file); !magic) return tl::unexpected(magic.error());
  auto contents = ReadAny(file);
  if (!contents) return contents;
  return CheckReferences(file, *contents).map([&] { return *std::move(contents); });
}

namespace {

std::unique_ptr<std::vector<RecordedTopic>> TopicsOf(const McapContents& contents) {
  auto topics = std::make_unique<std::vector<RecordedTopic>>();
  for (const auto& [id, channel] : contents.channels) {
    RecordedTopic& topic = topics->emplace_back(RecordedTopic{channel, {}, 0});
    const auto schema = contents.schemas.find(channel.schema_id);
    if (schema != contents.schemas.end()) topic.schema = schema->second;
    const auto count = contents.statistics.channel_counts.find(id);
    if (count != contents.statistics.channel_counts.end()) topic.message_count = count->second;
  }
  std::stable_sort(topics->begin(), topics->end(),
                   [](const auto& a, const auto& b) { return a.channel.topic < b.channel.topic; });
  return topics;
}

}  // namespace

Result<McapReader> McapReader::Open(const std::filesystem::path& path, std::uint64_t memory_limit) {
  auto file = InputFile::Open(path);
  if (!file) return tl::unexpected(file.error());
  auto contents = ReadContents(*file);
  if (!contents) return tl::unexpected(contents.error());
  McapReader reader(*std::move(file), *std::move(contents), memory_limit);
  std::filesystem::path last = path;
  std::error_code ignored;
  for (auto next = FollowingFile(last); std::filesystem::exists(next, ignored);
       last = std::exchange(next, FollowingFile(next))) {
    auto part = Open(next, memory_limit);
    if (part && part->FactOf(kFactsName, kFollowsFact) != last.filename().string()) break;
    if (part) {
      reader.GoOnWith(*std::move(part));
      break;
    }
    reader.NoteMissing(part.error().text + "; left out");
  }
  return reader;
}

McapReader::McapReader(InputFile file, McapContents contents, std::uint64_t memory_limit)
    : file_(std::move(file)),
      contents_(std::move(contents)),
      topics_(TopicsOf(contents_)),
      chunk_order_(contents_.chunks.size()),
      memory_limit_(memory_limit) {
  NoteMissing(contents_.cut_off);
  if (const std::string lost = FactOf(kLostName, kLostFact); !lost.empty()) {
    NoteMissing(
        fmt::format("messages lost: {} (the disk was full, or too many came at once)", lost));
  }
  std::iota(chunk_order_.begin(), chunk_order_.end(), std::size_t{0});
  std::stable_sort(chunk_order_.begin(), chunk_order_.end(), [this](std::size_t a, std::size_t b) {
    return contents_.chunks[a].start_time < contents_.chunks[b].start_time;
  });
}

bool McapReader::IsLater(const Waiting& a, const Waiting& b) {
  return std::tie(a.log_time, a.chunk, a.position) > std::tie(b.log_time, b.chunk, b.position);
}

const RecordedTopic* McapReader::TopicOf(std::uint16_t channel_id) const {
  const auto topic = std::find_if(topics_->begin(), topics_->end(), [&](const auto& candidate) {
    return candidate.channel.id == channel_id;
  });
  return topic == topics_->end() ? nullptr : &*topic;
}

bool McapReader::NeedsChunk() const {
  if (next_chunk_ == chunk_order_.size()) return false;
  return heap_.empty() ||
         contents_.chunks[chunk_order_[next_chunk_]].start_time <= heap_.front().log_time;
}

Result<void> McapReader::LoadChunk() {
  const std::size_t chunk = chunk_order_[next_chunk_++];
  const ChunkIndex& index = contents_.chunks[chunk];
  if (index.end_time < from_) return {};
  auto records = ReadChunkAt(file_, index.offset, index.length);
  if (!records) return tl::unexpected(records.error());
  *held_bytes_ += records->size();
  const std::shared_ptr<const Bytes> owner(new Bytes(*std::move(records)),
                                           [held = held_bytes_](const Bytes* bytes) {
                                             *held -= bytes->size();
                                             delete bytes;
                                           });
  ByteSpan rest = *owner;
  while (!rest.empty()) {
    if (*held_bytes_ + heap_.size() * sizeof(Waiting) > memory_limit_) {
      return DamagedAt(file_, index.offset,
                       fmt::format("chunks that overlap in time take more than {} bytes of memory",
                                   memory_limit_),
                       ErrorCode::kRefused);
    }
    const std::size_t position = owner->size() - rest.size();
    const auto record = TakeRecord(rest);
    if (!record) return DamagedAt(file_, index.offset, "chunk: it ends within a record");
    if (record->opcode != Opcode::kMessage) continue;
    const auto message = ReadMessage(record->content);
    const bool is_known = message && TopicOf(message->header.channel_id) != nullptr;
    if (message && !is_known && !contents_.cut_off.empty()) continue;  // that says so
    if (!is_known) return DamagedAt(file_, index.offset, "chunk: a message in it is damaged");
    if (message->header.log_time < from_) continue;
    heap_.push_back({message->header.log_time, chunk, position, *message, owner});
    std::push_heap(heap_.begin(), heap_.end(), IsLater);
  }
  return {};
}

Result<std::optional<RecordedMessage>> McapReader::Next() {
  while (NeedsChunk()) {
    if (auto loaded = LoadChunk(); !loaded) return tl::unexpected(loaded.error());
  }
  if (heap_.empty() && !next_) return std::nullopt;
  if (heap_.empty()) {
    auto message = next_->Next();
    if (message && *message) (*message)->topic = SharedTopic((*message)->topic);
    return message;
  }
  std::pop_heap(heap_.begin(), heap_.end(), IsLater);
  const Waiting first = std::move(heap_.back());
  heap_.pop_back();
  const MessageHeader& header = first.message.header;
  return RecordedMessage{SharedTopic(TopicOf(header.channel_id)),
                         header.sequence,
                         header.log_time,
                         header.publish_time,
                         first.message.data,
                         first.owner};
}

void McapReader::Seek(std::uint64_t log_time) {
  from_ = log_time;
  next_chunk_ = 0;
  heap_.clear();
  if (next_) next_->Seek(log_time);
}

}  // namespace conav::bag
