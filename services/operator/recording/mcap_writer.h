#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "operator/recording/mcap_records.h"
#include "operator/recording/recording_files.h"

// One user: the recorder; the file format is tested without it.

namespace conav::bag {

/// Writes one MCAP file (profile "ros2"): messages in zstd chunks with an index behind each, and a
/// summary at the end.
///
/// Whatever happens to the process, the file can be read up to the last chunk that was written: a
/// chunk holds every schema and channel that it uses first, and no chunk is written in part. When
/// the disk fails, the messages of that chunk are lost, and the next chunk may succeed.
/// Threads: one. Blocks on the disk in Flush, in Finish, and in Write when a chunk is full.
class McapWriter {
 public:
  struct Options {
    std::string library = "conav";      // who wrote the file
    std::size_t chunk_bytes = 1 << 20;  // a chunk is flushed when it holds so much, uncompressed
    int compression_level = 3;          // of zstd
  };

  /// Makes the file with its header and `metadata`. Errors: kIo with path and cause; a file that
  /// exists is not touched.
  [[nodiscard]] static Result<McapWriter> Create(const std::filesystem::path& path,
                                                 const Options& options,
                                                 const std::vector<Metadata>& metadata);

  /// Channels with the same schema name share the schema. Returns the channel's id; nothing is
  /// written before its first message. `schema.id`, `channel.id` and `channel.schema_id` are set
  /// here.
  std::uint16_t AddChannel(Schema schema, Channel channel);

  /// Adds a message; its sequence number counts those of its channel from 1. Errors: those of
  /// Flush.
  [[nodiscard]] Result<void> Write(std::uint16_t channel, std::uint64_t log_time,
                                   std::uint64_t publish_time, ByteSpan data);

  /// Writes what is gathered as a chunk. Errors: kIo with path and cause; then the messages of this
  /// chunk are lost.
  [[nodiscard]] Result<void> Flush();

  /// Flushes and writes the summary; nothing may be written afterwards. Errors: kIo with path and
  /// cause; then the file has no summary, and the reader finds out for itself what is in it.
  [[nodiscard]] Result<void> Finish();

  /// Messages that are in no chunk yet.
  std::uint64_t pending() const { return pending_; }
  /// Messages in the file, and those that could not be written.
  std::uint64_t message_count() const { return statistics_.message_count; }
  std::uint64_t lost() const { return lost_; }
  std::uint64_t file_size() const { return file_.size(); }

 private:
  enum class Announced { kNot, kInChunk, kInFile };
  struct SchemaState {
    Schema schema;
    Announced announced = Announced::kNot;
  };
  struct ChannelState {
    Channel channel;
    Announced announced = Announced::kNot;
    std::uint32_t sequence = 0;
    std::vector<MessageIndexEntry> entries;  // in the chunk that is gathered
  };

  McapWriter(AppendedFile file, const Options& options)
      : options_(options), file_(std::move(file)) {}

  Result<void> Begin(const std::vector<Metadata>& metadata);
  Result<void> AppendBlock(const Bytes& block);
  void Announce(ChannelState& channel);
  /// The chunk record and its message indexes; `index` says where they will be.
  Bytes PackChunk(ChunkIndex& index);
  void Commit(ChunkIndex index);
  void ForgetChunk(Announced announced);
  Footer AppendSummaryGroups(Bytes& out, std::uint64_t summary_start) const;

  Options options_;
  AppendedFile file_;
  std::uint32_t data_crc_ = 0;        // of the file so far
  std::vector<SchemaState> schemas_;  // id - 1 is the index, as for the next
  std::vector<ChannelState> channels_;
  Bytes chunk_;
  std::uint64_t pending_ = 0;
  ChunkHeader chunk_header_;
  std::vector<ChunkIndex> chunks_;
  std::vector<MetadataIndex> metadata_;
  Statistics statistics_;
  std::uint64_t lost_ = 0;
};

}  // namespace conav::bag
