#include <algorithm>
#include <functional>
#include <utility>

#include "operator/recording/mcap_file.h"

namespace conav::bag {
namespace {

std::string_view TextOf(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<McapWriter> McapWriter::Create(const std::filesystem::path& path, const Options& options,
                                      const std::vector<Metadata>& metadata) {
  Result<AppendedFile> file = AppendedFile::Create(path);
  if (!file) return tl::unexpected(file.error());
  McapWriter writer(*std::move(file), options);
  if (auto begun = writer.Begin(metadata); !begun) return tl::unexpected(begun.error());
  return writer;
}

Result<void> McapWriter::Begin(const std::vector<Metadata>& metadata) {
  Bytes block(std::begin(kMagic), std::end(kMagic));
  Append(block, Header{"ros2", options_.library});
  for (const Metadata& record : metadata) {
    const std::size_t offset = block.size();
    Append(block, record);
    metadata_.push_back({offset, block.size() - offset, record.name});
  }
  statistics_.metadata_count = static_cast<std::uint32_t>(metadata.size());
  return AppendBlock(block);
}

Result<void> McapWriter::AppendBlock(const Bytes& block) {
  return file_.Append(TextOf(block)).map([&] { data_crc_ = Crc32(block, data_crc_); });
}

std::uint16_t McapWriter::AddChannel(Schema schema, Channel channel) {
  DEMAND(channels_.size() < UINT16_MAX, channel.topic);
  auto known = std::find_if(schemas_.begin(), schemas_.end(), [&](const SchemaState& state) {
    return state.schema.name == schema.name;
  });
  if (known == schemas_.end()) {
    schema.id = static_cast<std::uint16_t>(schemas_.size() + 1);
    known = schemas_.insert(known, {std::move(schema), Announced::kNot});
  }
  channel.schema_id = known->schema.id;
  channel.id = static_cast<std::uint16_t>(channels_.size() + 1);
  channels_.push_back({std::move(channel), Announced::kNot, 0, {}});
  return channels_.back().channel.id;
}

void McapWriter::Announce(ChannelState& channel) {
  SchemaState& schema = schemas_[channel.channel.schema_id - 1U];
  if (schema.announced == Announced::kNot) {
    Append(chunk_, schema.schema);
    schema.announced = Announced::kInChunk;
  }
  if (channel.announced == Announced::kNot) {
    Append(chunk_, channel.channel);
    channel.announced = Announced::kInChunk;
  }
}

Result<void> McapWriter::Write(std::uint16_t channel_id, std::uint64_t log_time,
                               std::uint64_t publish_time, ByteSpan data) {
  DEMAND(channel_id > 0 && channel_id <= channels_.size(), channel_id);
  ChannelState& channel = channels_[channel_id - 1U];
  if (pending_ == 0) {  // those without messages, too, so that a reader finds every type
    for (ChannelState& any : channels_) Announce(any);
  }
  Announce(channel);
  if (pending_ == 0) chunk_header_ = {.start_time = log_time, .end_time = log_time};
  chunk_header_.start_time = std::min(chunk_header_.start_time, log_time);
  chunk_header_.end_time = std::max(chunk_header_.end_time, log_time);
  channel.entries.emplace_back(log_time, chunk_.size());
  Append(chunk_, MessageHeader{channel_id, ++channel.sequence, log_time, publish_time}, data);
  ++pending_;
  if (chunk_.size() < options_.chunk_bytes) return {};
  return Flush();
}

Bytes McapWriter::PackChunk(ChunkIndex& index) {
  chunk_header_.uncompressed_size = chunk_.size();
  chunk_header_.uncompressed_crc = Crc32(chunk_);
  chunk_header_.compression = "zstd";
  const Bytes compressed = Compress(chunk_, options_.compression_level);
  Bytes block;
  Append(block, chunk_header_, compressed);
  index = {.start_time = chunk_header_.start_time,
           .end_time = chunk_header_.end_time,
           .offset = file_.size(),
           .length = block.size(),
           .compression = chunk_header_.compression,
           .compressed_size = compressed.size(),
           .uncompressed_size = chunk_.size()};
  for (ChannelState& channel : channels_) {
    if (channel.entries.empty()) continue;
    std::stable_sort(channel.entries.begin(), channel.entries.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    index.message_index_offsets[channel.channel.id] = file_.size() + block.size();
    Append(block, MessageIndex{channel.channel.id, channel.entries});
  }
  index.message_index_length = block.size() - index.length;
  return block;
}

void McapWriter::Commit(const ChunkIndex& index) {
  const bool first = statistics_.message_count == 0;
  statistics_.start_time =
      first ? index.start_time : std::min(statistics_.start_time, index.start_time);
  statistics_.end_time = std::max(statistics_.end_time, index.end_time);
  statistics_.message_count += pending_;
  for (const ChannelState& channel : channels_) {
    if (channel.entries.empty()) continue;
    statistics_.channel_counts[channel.channel.id] += channel.entries.size();
  }
  ++statistics_.chunk_count;
  Append(chunk_indexes_, index);
}

void McapWriter::ForgetChunk(Announced announced) {
  for (SchemaState& schema : schemas_) {
    if (schema.announced == Announced::kInChunk) schema.announced = announced;
  }
  for (ChannelState& channel : channels_) {
    if (channel.announced == Announced::kInChunk) channel.announced = announced;
    channel.entries.clear();
  }
  chunk_.clear();
  pending_ = 0;
}

Result<void> McapWriter::Flush() {
  if (pending_ == 0) return {};
  ChunkIndex index;
  const Bytes block = PackChunk(index);
  const Result<void> written = AppendBlock(block);
  if (written) {
    Commit(index);
    ForgetChunk(Announced::kInFile);
  } else {
    lost_ += pending_;
    ForgetChunk(Announced::kNot);
  }
  return written;
}

Footer McapWriter::AppendSummaryGroups(Bytes& out, std::uint64_t summary_start) const {
  Bytes offsets;
  const auto group = [&](Opcode opcode, const std::function<void()>& append) {
    const std::size_t begin = out.size();
    append();
    if (out.size() == begin) return;
    Append(offsets, SummaryOffset{static_cast<std::uint8_t>(opcode), summary_start + begin,
                                  out.size() - begin});
  };
  group(Opcode::kSchema, [&] {
    for (const SchemaState& state : schemas_) {
      if (state.announced == Announced::kInFile) Append(out, state.schema);
    }
  });
  group(Opcode::kChannel, [&] {
    for (const ChannelState& state : channels_) {
      if (state.announced == Announced::kInFile) Append(out, state.channel);
    }
  });
  group(Opcode::kStatistics, [&] {
    const auto in_file = [](const auto& state) { return state.announced == Announced::kInFile; };
    Statistics statistics = statistics_;
    statistics.schema_count =
        static_cast<std::uint16_t>(std::count_if(schemas_.begin(), schemas_.end(), in_file));
    statistics.channel_count =
        static_cast<std::uint32_t>(std::count_if(channels_.begin(), channels_.end(), in_file));
    Append(out, statistics);
  });
  group(Opcode::kChunkIndex,
        [&] { out.insert(out.end(), chunk_indexes_.begin(), chunk_indexes_.end()); });
  group(Opcode::kMetadataIndex, [&] {
    for (const MetadataIndex& index : metadata_) Append(out, index);
  });
  const Footer footer{.summary_start = summary_start,
                      .summary_offset_start = summary_start + out.size()};
  out.insert(out.end(), offsets.begin(), offsets.end());
  return footer;
}

Result<void> McapWriter::Finish() {
  const Result<void> flushed = Flush();
  Bytes block;
  if (lost_ > 0) {
    Append(block, Metadata{kLostName, {{kLostFact, std::to_string(lost_)}}});
    metadata_.push_back({file_.size(), block.size(), kLostName});
    ++statistics_.metadata_count;
  }
  Append(block, DataEnd{Crc32(block, data_crc_)});
  Bytes summary;
  Append(summary, AppendSummaryGroups(summary, file_.size() + block.size()));
  summary.erase(summary.end() - static_cast<std::ptrdiff_t>(kFooterCrcSize), summary.end());
  ByteWriter(summary).Put(Crc32(summary));
  block.insert(block.end(), summary.begin(), summary.end());
  block.insert(block.end(), std::begin(kMagic), std::end(kMagic));
  const Result<void> written = file_.Append(TextOf(block));
  if (!written && lost_ > 0) {
    metadata_.pop_back();
    --statistics_.metadata_count;
  }
  return flushed ? written : flushed;
}

}  // namespace conav::bag
