#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/runtime/file.h"
#include "common/runtime/result.h"
#include "operator/recording/mcap_records.h"

/// Recordings as MCAP files: written, read, and exported as rosbag2.
namespace conav::bag {

/// The definitions of message types as ROS 2 writes them in .msg files and as MCAP's schema
/// encoding "ros2msg" has them, not as "ros2idl" (the IDL as it is), which Foxglove and Lichtblick
/// read but mcap-ros2-support for Python and PlotJuggler's ROS parser do not: the type's fields,
/// then, behind a line of '=' and "MSG: package/Name", those of every type that it is made of.
///
/// IDL keeps constants in a module next to the struct, "RobotState_Constants". A field whose comment
/// names constants ("COMMAND_KIND_*", or one by its whole name) gets them in the lines
/// before it, where Foxglove takes them for the names of its values.
///
/// By type: "conav_msgs/msg/RobotState".
using MessageSchemas = std::map<std::string, std::string>;

/// Of every struct of `idl`, which is the part of OMG IDL in which conav's messages are written:
/// `module PACKAGE { module msg { ... }; };` with structs (of numbers, texts, other structs, arrays
/// of one dimension, sequences) and modules of constant numbers. It may be several files behind one another,
/// each after those that it includes; lines that begin with '#' are left out. Errors: kMalformed:
/// anything else, with the number of the line.
[[nodiscard]] Result<MessageSchemas> SchemasOf(std::string_view idl);

/// Of idl/: every type of a topic. Read from the text that the program was built with.
const MessageSchemas& ConavSchemas();

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

  /// Messages that never came so far are lost, too.
  void NoteLost(std::uint64_t messages) { lost_ += messages; }
  /// Flushes and writes the summary, and how many messages are lost; nothing may be written afterwards. Errors: kIo with path and
  /// cause; then the file has no summary, and the reader finds out for itself what is in it.
  [[nodiscard]] Result<void> Finish();

  /// Messages that are in no chunk yet.
  std::uint64_t pending() const { return pending_; }
  /// Messages in the file, and those that could not be written.
  std::uint64_t message_count() const { return statistics_.message_count; }
  std::uint64_t lost() const { return lost_; }
  std::uint64_t file_size() const { return file_.size(); }
  /// What the writer keeps in memory for the summary.
  std::size_t index_size() const { return chunk_indexes_.size(); }

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
    /// In the chunk that is gathered.
    std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;
  };

  McapWriter(AppendedFile file, const Options& options)
      : options_(options), file_(std::move(file)) {}

  Result<void> Begin(const std::vector<Metadata>& metadata);
  Result<void> AppendBlock(const Bytes& block);
  void Announce(ChannelState& channel);
  /// The chunk record and its message indexes; `index` says where they will be.
  Bytes PackChunk(ChunkIndex& index);
  void Commit(const ChunkIndex& index);
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
  Bytes chunk_indexes_;  // records of the summary: the part of the writer that grows with the file
  std::vector<MetadataIndex> metadata_;
  Statistics statistics_;
  std::uint64_t lost_ = 0;
};

/// recording.mcap, recording-2.mcap, recording-3.mcap and so on.
std::filesystem::path NumberedFile(const std::filesystem::path& first, int number);
/// Those that are there, by their numbers.
std::map<int, std::filesystem::path> FilesLike(const std::filesystem::path& first);
/// The name of the one after `file`, which may be the first one or a numbered one.
std::filesystem::path FollowingFile(const std::filesystem::path& file);

/// Metadata that conav's recordings have: facts of the run, in each file, with the name of the file
/// that it follows; and how many messages are not in the file, if any.
inline constexpr const char* kFactsName = "conav";
inline constexpr const char* kFollowsFact = "follows";
inline constexpr const char* kLostName = "conav_lost";
inline constexpr const char* kLostFact = "messages";

/// The first file of the recording of `run`, a run's folder or the file itself, which need not exist.
/// Errors: kNotFound: a folder without one.
[[nodiscard]] Result<std::filesystem::path> RecordingOf(const std::filesystem::path& run);

/// A file that is read in pieces. Threads: one.
class InputFile {
 public:
  /// Errors: kNotFound, kIo, each with the path; a folder is kIo.
  [[nodiscard]] static Result<InputFile> Open(const std::filesystem::path& path);

  /// Errors: kIo with the path (also when the file has become shorter), kMalformed when the piece
  /// is not in the file.
  [[nodiscard]] Result<Bytes> Read(std::uint64_t offset, std::uint64_t size) const;

  /// When it was opened.
  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  InputFile(std::filesystem::path path, FileDescriptor descriptor, std::uint64_t size)
      : path_(std::move(path)), descriptor_(std::move(descriptor)), size_(size) {}

  std::filesystem::path path_;
  FileDescriptor descriptor_;
  std::uint64_t size_;
};

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
///
/// A recording that goes on in further files, since its recorder was killed or a file was full, is
/// read like one: the messages of each file in turn, topics of the same name and type together.
/// Threads: one. Blocks on the disk. Holds one chunk in memory, more where chunks overlap in time, up
/// to the limit.
class McapReader {
 public:
  /// `memory_limit`: bytes. Errors: see ReadContents, and those of InputFile::Open.
  [[nodiscard]] static Result<McapReader> Open(const std::filesystem::path& path,
                                               std::uint64_t memory_limit = kReadLimit);

  /// By topic.
  const std::vector<RecordedTopic>& topics() const { return all_topics_ ? *all_topics_ : *topics_; }
  /// Of the first file.
  const std::vector<Metadata>& metadata() const { return contents_.metadata; }
  std::uint64_t message_count() const {
    return contents_.statistics.message_count + (next_ ? next_->message_count() : 0);
  }
  /// Log times of the first and the last message; 0 without messages.
  std::uint64_t start_time() const;
  std::uint64_t end_time() const;
  std::uint64_t file_size() const { return file_.size() + (next_ ? next_->file_size() : 0); }
  /// 1, or more where it goes on.
  int files() const { return 1 + (next_ ? next_->files() : 0); }
  /// Empty for a whole recording; otherwise what is missing, in words: the end of a file that was
  /// not finished, messages that were not written, a file that cannot be read.
  const std::string& cut_off() const { return missing_; }

  /// The next message in the order of log times, and of the file where these are equal; nothing at
  /// the end. Errors: see ReadContents, and kRefused for a chunk that overlaps with too many others;
  /// the next call goes on behind that chunk.
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

  McapReader(InputFile file, McapContents contents, std::uint64_t memory_limit);
  bool NeedsChunk() const;
  Result<void> LoadChunk();
  const RecordedTopic* TopicOf(std::uint16_t channel_id) const;
  /// The one of topics() that stands for `topic` of this file or of the next one.
  const RecordedTopic* SharedTopic(const RecordedTopic* topic) const {
    return all_topics_ ? shared_topics_.at(topic) : topic;
  }
  /// Of this file; empty = none.
  std::string FactOf(std::string_view record, const std::string& name) const;
  void NoteMissing(const std::string& what);
  void GoOnWith(McapReader part);

  InputFile file_;
  McapContents contents_;
  std::unique_ptr<std::vector<RecordedTopic>> topics_;  // stays where it is when the reader moves
  std::vector<std::size_t> chunk_order_;                // by start time
  std::size_t next_chunk_ = 0;                          // index into chunk_order_
  std::uint64_t from_ = 0;
  std::vector<Waiting> heap_;
  std::shared_ptr<std::uint64_t> held_bytes_ = std::make_shared<std::uint64_t>();  // of chunks
  std::uint64_t memory_limit_ = kReadLimit;
  std::string missing_;
  std::unique_ptr<McapReader> next_;  // the file that follows this one
  std::unique_ptr<std::vector<RecordedTopic>>
      all_topics_;  // with those of next_, where it is there
  std::map<const RecordedTopic*, const RecordedTopic*> shared_topics_;
};

/// Writes all messages of a recording as a rosbag2 folder:
///
///   FOLDER/metadata.yaml     version 5
///          <name>_0.db3      SQLite; times are log times, QoS that of the channels' metadata
///
/// `progress` is called now and then with the number of messages written so far. Damaged chunks are
/// left out. After an error nothing of the folder is left.
/// Gives what is wrong with the chunks that were left out, in words.
/// Errors: kRefused: the folder exists, or a topic is not CDR with ros2msg; kIo with path and cause.
[[nodiscard]] Result<std::vector<std::string>> WriteRosbag2(
    McapReader& reader, const std::filesystem::path& folder,
    const std::function<void(std::uint64_t)>& progress);

}  // namespace conav::bag
