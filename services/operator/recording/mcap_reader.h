#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "operator/recording/mcap_records.h"
#include "operator/recording/recording_files.h"

namespace conav::bag {

/// The recording of `run`, a run's folder or the file itself, which need not exist.
/// Errors: kNotFound: a folder without one.
[[nodiscard]] Result<std::filesystem::path> RecordingOf(const std::filesystem::path& run);

/// What is in an MCAP file, and where.
struct McapContents {
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;  // each names one of the schemas, or 0 for none
  std::vector<ChunkIndex> chunks;             // in the order of the file
  Statistics statistics;
  std::vector<Metadata> metadata;
  /// Empty for a file that was finished; otherwise what is missing, in words.
  std::string cut_off;
};

/// From the summary at the end; by reading all chunks where there is no summary, which says so in
/// `cut_off` if the file was not finished.
/// Errors, each with the path: kIo; kMalformed: no MCAP file, a record or a chunk that is damaged
/// (but at the very end of a file that was not finished: that is cut off), a channel or schema that
/// is not there; kRefused: messages outside of chunks, compression that is not read here.
[[nodiscard]] Result<McapContents> ReadContents(const InputFile& file);

struct RecordedTopic {
  Channel channel;
  Schema schema;  // empty for a channel without one
  std::uint64_t message_count = 0;
};

struct RecordedMessage {
  const RecordedTopic* topic;  // one of the reader's topics()
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;      // ns since 1970, wall time of arrival
  std::uint64_t publish_time = 0;  // ns; simulation time of the message's header where it has one
  ByteSpan data;                   // CDR with its 4-byte encapsulation header
  std::shared_ptr<const Bytes> owner;  // of `data`: it lives as long as this
};

/// Reads an MCAP file whose messages are in chunks, compressed with zstd or not at all: a finished
/// one by its summary, one that was cut off (a kill -9, a full disk, a copy of a run that goes on)
/// by looking through all of it.
/// Threads: one. Blocks on the disk. Holds one chunk in memory, more where chunks overlap in time.
class McapReader {
 public:
  /// Errors: see ReadContents, and those of InputFile::Open.
  [[nodiscard]] static Result<McapReader> Open(const std::filesystem::path& path);

  /// By topic.
  const std::vector<RecordedTopic>& topics() const { return *topics_; }
  const std::vector<Metadata>& metadata() const { return contents_.metadata; }
  std::uint64_t message_count() const { return contents_.statistics.message_count; }
  /// Log times of the first and the last message; 0 without messages.
  std::uint64_t start_time() const { return contents_.statistics.start_time; }
  std::uint64_t end_time() const { return contents_.statistics.end_time; }
  std::uint64_t file_size() const { return file_.size(); }
  /// Empty for a file that was finished; otherwise what is missing, in words.
  const std::string& cut_off() const { return contents_.cut_off; }

  /// The next message in the order of log times, and of the file where these are equal; nothing at
  /// the end. Errors: see ReadContents; the next call goes on behind the damaged chunk.
  [[nodiscard]] Result<std::optional<RecordedMessage>> Next();

  /// Next() goes on with the first message that was logged at `log_time` or later.
  void Seek(std::uint64_t log_time);

 private:
  struct Waiting {
    std::uint64_t log_time;
    std::size_t chunk;     // index into contents_.chunks, for the order
    std::size_t position;  // in the chunk
    MessageRecord message;
    std::shared_ptr<const Bytes> owner;
  };
  static bool IsLater(const Waiting& a, const Waiting& b);

  McapReader(InputFile file, McapContents contents);
  bool NeedsChunk() const;
  Result<void> LoadChunk();
  const RecordedTopic* TopicOf(std::uint16_t channel_id) const;

  InputFile file_;
  McapContents contents_;
  std::unique_ptr<std::vector<RecordedTopic>> topics_;  // stays where it is when the reader moves
  std::vector<std::size_t> chunk_order_;                // by start time
  std::size_t next_chunk_ = 0;                          // index into chunk_order_
  std::uint64_t from_ = 0;
  std::vector<Waiting> heap_;
};

}  // namespace conav::bag
