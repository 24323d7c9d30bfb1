#include "operator/recording/mcap_records.h"

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include <tuple>

namespace conav::bag {
namespace {

/// Writes opcode and, when it ends, the length of what was appended meanwhile.
class RecordScope {
 public:
  RecordScope(Bytes& out, Opcode opcode) : writer_(out) {
    writer_.Put(static_cast<std::uint8_t>(opcode));
    length_at_ = writer_.BeginLength(8);
  }
  ~RecordScope() { writer_.EndLength(length_at_, 8); }
  RecordScope(const RecordScope&) = delete;
  RecordScope& operator=(const RecordScope&) = delete;
  ByteWriter& writer() { return writer_; }

 private:
  ByteWriter writer_;
  std::size_t length_at_;
};

// The fields of each record in the order of the file.
constexpr auto FieldsOf(const Header&) { return std::tuple(&Header::profile, &Header::library); }
constexpr auto FieldsOf(const Schema&) {
  return std::tuple(&Schema::id, &Schema::name, &Schema::encoding, &Schema::text);
}
constexpr auto FieldsOf(const Channel&) {
  return std::tuple(&Channel::id, &Channel::schema_id, &Channel::topic, &Channel::message_encoding,
                    &Channel::metadata);
}
constexpr auto FieldsOf(const MessageHeader&) {
  using R = MessageHeader;
  return std::tuple(&R::channel_id, &R::sequence, &R::log_time, &R::publish_time);
}
constexpr auto FieldsOf(const ChunkHeader&) {
  using R = ChunkHeader;
  return std::tuple(&R::start_time, &R::end_time, &R::uncompressed_size, &R::uncompressed_crc,
                    &R::compression);
}
constexpr auto FieldsOf(const MessageIndex&) {
  return std::tuple(&MessageIndex::channel_id, &MessageIndex::entries);
}
constexpr auto FieldsOf(const ChunkIndex&) {
  using R = ChunkIndex;
  return std::tuple(&R::start_time, &R::end_time, &R::offset, &R::length, &R::message_index_offsets,
                    &R::message_index_length, &R::compression, &R::compressed_size,
                    &R::uncompressed_size);
}
constexpr auto FieldsOf(const Statistics&) {
  using R = Statistics;
  return std::tuple(&R::message_count, &R::schema_count, &R::channel_count, &R::attachment_count,
                    &R::metadata_count, &R::chunk_count, &R::start_time, &R::end_time,
                    &R::channel_counts);
}
constexpr auto FieldsOf(const Metadata&) { return std::tuple(&Metadata::name, &Metadata::values); }
constexpr auto FieldsOf(const MetadataIndex&) {
  return std::tuple(&MetadataIndex::offset, &MetadataIndex::length, &MetadataIndex::name);
}
constexpr auto FieldsOf(const SummaryOffset&) {
  return std::tuple(&SummaryOffset::group, &SummaryOffset::start, &SummaryOffset::length);
}
constexpr auto FieldsOf(const DataEnd&) { return std::tuple(&DataEnd::data_crc); }
constexpr auto FieldsOf(const Footer&) {
  return std::tuple(&Footer::summary_start, &Footer::summary_offset_start, &Footer::summary_crc);
}

template <class T>
void PutFields(ByteWriter& writer, const T& record) {
  std::apply([&](auto... field) { (writer.Put(record.*field), ...); }, FieldsOf(record));
}

template <class T>
void TakeFields(ByteReader& reader, T& record) {
  std::apply([&](auto... field) { (reader.Take(record.*field), ...); }, FieldsOf(record));
}

template <class T>
std::optional<T> IfWhole(const ByteReader& reader, T value) {
  if (!reader.ok()) return std::nullopt;
  return value;
}

}  // namespace

template <class T>
void Append(Bytes& out, const T& record) {
  RecordScope scope(out, T::kOpcode);
  PutFields(scope.writer(), record);
}
template void Append(Bytes& out, const Header& record);
template void Append(Bytes& out, const Schema& record);
template void Append(Bytes& out, const Channel& record);
template void Append(Bytes& out, const MessageIndex& record);
template void Append(Bytes& out, const ChunkIndex& record);
template void Append(Bytes& out, const Statistics& record);
template void Append(Bytes& out, const Metadata& record);
template void Append(Bytes& out, const MetadataIndex& record);
template void Append(Bytes& out, const SummaryOffset& record);
template void Append(Bytes& out, const DataEnd& record);
template void Append(Bytes& out, const Footer& record);

void Append(Bytes& out, const MessageHeader& header, ByteSpan data) {
  RecordScope scope(out, Opcode::kMessage);
  PutFields(scope.writer(), header);
  scope.writer().Raw(data);
}

void Append(Bytes& out, const ChunkHeader& header, ByteSpan compressed) {
  RecordScope scope(out, Opcode::kChunk);
  PutFields(scope.writer(), header);
  scope.writer().Put(std::uint64_t{compressed.size()});
  scope.writer().Raw(compressed);
}

template <class T>
std::optional<T> Read(ByteSpan content) {
  ByteReader reader(content);
  T record;
  TakeFields(reader, record);
  return IfWhole(reader, std::move(record));
}
template std::optional<Schema> Read(ByteSpan content);
template std::optional<Channel> Read(ByteSpan content);
template std::optional<ChunkIndex> Read(ByteSpan content);
template std::optional<Statistics> Read(ByteSpan content);
template std::optional<Metadata> Read(ByteSpan content);
template std::optional<MetadataIndex> Read(ByteSpan content);
template std::optional<Footer> Read(ByteSpan content);

std::optional<MessageRecord> ReadMessage(ByteSpan content) {
  ByteReader reader(content);
  MessageRecord message;
  TakeFields(reader, message.header);
  message.data = reader.Raw(reader.left());
  return IfWhole(reader, message);
}

std::optional<ChunkRecord> ReadChunk(ByteSpan content) {
  ByteReader reader(content);
  ChunkRecord chunk;
  TakeFields(reader, chunk.header);
  chunk.compressed = reader.Raw(reader.Take<std::uint64_t>());
  return IfWhole(reader, std::move(chunk));
}

std::optional<Record> TakeRecord(ByteSpan& bytes) {
  ByteReader reader(bytes);
  const auto opcode = static_cast<Opcode>(reader.Take<std::uint8_t>());
  const ByteSpan content = reader.Raw(reader.Take<std::uint64_t>());
  if (!reader.ok()) return std::nullopt;
  bytes = bytes.subspan(kRecordHeaderSize + content.size());
  return Record{opcode, content};
}

std::uint32_t Crc32(ByteSpan bytes, std::uint32_t crc) {
  return static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

namespace {

Result<Bytes> Decompress(const ChunkRecord& chunk) {
  Bytes bytes(chunk.header.uncompressed_size);
  const std::size_t size =
      ZSTD_decompress(bytes.data(), bytes.size(), chunk.compressed.data(), chunk.compressed.size());
  if (ZSTD_isError(size) != 0) {
    return Fail(ErrorCode::kMalformed, fmt::format("zstd says: {}", ZSTD_getErrorName(size)));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

Bytes Compress(ByteSpan bytes, int level) {
  Bytes compressed(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), level);
  DEMAND(ZSTD_isError(size) == 0, ZSTD_getErrorName(size));
  compressed.resize(size);
  return compressed;
}

Result<Bytes> Unpack(const ChunkRecord& chunk) {
  const ChunkHeader& header = chunk.header;
  if (header.compression != "zstd" && !header.compression.empty()) {
    return Fail(
        ErrorCode::kRefused,
        fmt::format("compressed with '{}'; only zstd and none are read", header.compression));
  }
  if (header.uncompressed_size > kLargestChunk) {
    return Fail(ErrorCode::kRefused, fmt::format("{} bytes unpacked; {} is the limit",
                                                 header.uncompressed_size, kLargestChunk));
  }
  Result<Bytes> bytes = header.compression.empty()
                            ? Bytes(chunk.compressed.begin(), chunk.compressed.end())
                            : Decompress(chunk);
  if (!bytes) return bytes;
  if (bytes->size() != header.uncompressed_size) {
    return Fail(ErrorCode::kMalformed, fmt::format("{} bytes unpacked instead of {}", bytes->size(),
                                                   header.uncompressed_size));
  }
  if (header.uncompressed_crc != 0 && Crc32(*bytes) != header.uncompressed_crc) {
    return Fail(ErrorCode::kMalformed, "the CRC is wrong");
  }
  return bytes;
}

}  // namespace conav::bag
