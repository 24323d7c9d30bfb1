#include "operator/recording/mcap_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace conav::bag {

Result<std::filesystem::path> RecordingOf(const std::filesystem::path& run) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(run, ignored)) return run;
  const std::filesystem::path file = run / "recording.mcap";
  if (std::filesystem::exists(file, ignored)) return file;
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: no recording.mcap in it: no run folder, or it ran with "
                          "--no-recording",
                          run.string()));
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

Result<McapReader> McapReader::Open(const std::filesystem::path& path) {
  auto file = InputFile::Open(path);
  if (!file) return tl::unexpected(file.error());
  auto contents = ReadContents(*file);
  if (!contents) return tl::unexpected(contents.error());
  return McapReader(*std::move(file), *std::move(contents));
}

McapReader::McapReader(InputFile file, McapContents contents)
    : file_(std::move(file)),
      contents_(std::move(contents)),
      topics_(TopicsOf(contents_)),
      chunk_order_(contents_.chunks.size()) {
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
  const auto owner = std::make_shared<const Bytes>(*std::move(records));
  ByteSpan rest = *owner;
  while (!rest.empty()) {
    const std::size_t position = owner->size() - rest.size();
    const auto record = TakeRecord(rest);
    if (!record) return DamagedAt(file_, index.offset, "chunk: it ends within a record");
    if (record->opcode != Opcode::kMessage) continue;
    const auto message = ReadMessage(record->content);
    const bool is_known = message && TopicOf(message->header.channel_id) != nullptr;
    if (message && !is_known && !cut_off().empty()) continue;  // that says so
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
  if (heap_.empty()) return std::nullopt;
  std::pop_heap(heap_.begin(), heap_.end(), IsLater);
  const Waiting first = std::move(heap_.back());
  heap_.pop_back();
  const MessageHeader& header = first.message.header;
  return RecordedMessage{TopicOf(header.channel_id), header.sequence,    header.log_time,
                         header.publish_time,        first.message.data, first.owner};
}

void McapReader::Seek(std::uint64_t log_time) {
  from_ = log_time;
  next_chunk_ = 0;
  heap_.clear();
}

}  // namespace conav::bag
