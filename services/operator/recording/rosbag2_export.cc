#include <fmt/core.h>
#include <sqlite3.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string_view>
#include <utility>

#include "common/runtime/file.h"
#include "operator/recording/mcap_file.h"

namespace conav::bag {
namespace {

struct Rosbag2Topic {
  std::string name;
  std::string type;         // "std_msgs/msg/String"
  std::string offered_qos;  // YAML list of profiles; may be empty
  std::uint64_t message_count = 0;
};

/// The SQLite file of a rosbag2 folder, with the tables of Humble (storage schema 3), written once.
/// Nothing is on disk before Commit.
///
/// Errors:  kIo with path and cause (disk full, read-only, ...).
/// Threads: one.
class Rosbag2Database {
 public:
  [[nodiscard]] static Result<Rosbag2Database> Create(const std::filesystem::path& file);

  [[nodiscard]] Result<void> AddTopic(std::int64_t id, const Rosbag2Topic& topic) {
    return Run(insert_topic_, id, topic.name, topic.type, topic.offered_qos);
  }
  /// `time` in nanoseconds since 1970; `data` is CDR with its encapsulation.
  [[nodiscard]] Result<void> AddMessage(std::int64_t topic_id, std::uint64_t time, ByteSpan data) {
    return Run(insert_message_, topic_id, static_cast<std::int64_t>(time), data);
  }
  /// With the text of metadata.yaml, which newer readers take from here. Call once, last.
  [[nodiscard]] Result<void> Commit(const std::string& metadata) {
    return Run(insert_metadata_, metadata).and_then([this] {
      return Execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC); COMMIT;");
    });
  }

 private:
  struct Closer {
    void operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Closer>;

  Rosbag2Database(sqlite3* connection, std::string file)
      : file_(std::move(file)), connection_(connection) {}
  Result<void> Prepare();
  /// Runs a prepared statement that gives no rows.
  template <class... Values>
  Result<void> Run(const Statement& statement, const Values&... values);
  Result<void> Execute(const std::string& sql);
  Error Failure() const;

  std::string file_;
  std::unique_ptr<sqlite3, Closer> connection_;
  Statement insert_topic_;
  Statement insert_message_;
  Statement insert_metadata_;
};

// The file is new and useless until it is complete, so nothing needs to be undone.
constexpr const char* kTables = R"(
  PRAGMA journal_mode = OFF;
  PRAGMA synchronous = OFF;
  BEGIN;
  CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
  CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
  CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
    serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
  CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
    data BLOB NOT NULL);
  INSERT INTO schema VALUES (3, 'humble');
)";

void Bind(sqlite3_stmt* statement, int index, std::int64_t number) {
  sqlite3_bind_int64(statement, index, number);
}
void Bind(sqlite3_stmt* statement, int index, const std::string& text) {
  sqlite3_bind_text64(statement, index, text.data(), text.size(), SQLITE_STATIC, SQLITE_UTF8);
}
void Bind(sqlite3_stmt* statement, int index, ByteSpan bytes) {
  sqlite3_bind_blob64(statement, index, bytes.data(), bytes.size(), SQLITE_STATIC);
}

template <class... Values>
Result<void> Rosbag2Database::Run(const Statement& statement, const Values&... values) {
  int index = 0;
  (Bind(statement.get(), ++index, values), ...);
  const bool done = sqlite3_step(statement.get()) == SQLITE_DONE;
  sqlite3_reset(statement.get());
  if (!done) return tl::unexpected(Failure());
  return {};
}

Error Rosbag2Database::Failure() const {
  return {ErrorCode::kIo, fmt::format("{}: {}", file_, sqlite3_errmsg(connection_.get()))};
}

Result<Rosbag2Database> Rosbag2Database::Create(const std::filesystem::path& file) {
  sqlite3* raw = nullptr;
  const int code =
      sqlite3_open_v2(file.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  Rosbag2Database database(raw, file.string());
  if (code != SQLITE_OK) return tl::unexpected(database.Failure());
  return database.Prepare().map([&] { return std::move(database); });
}

Result<void> Rosbag2Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(connection_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return tl::unexpected(Failure());
  return {};
}

Result<void> Rosbag2Database::Prepare() {
  if (auto made = Execute(kTables); !made) return made;
  const auto prepare = [&](const char* sql) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(connection_.get(), sql, -1, &statement, nullptr);
    return Statement(statement);
  };
  insert_topic_ = prepare("INSERT INTO topics VALUES (?, ?, ?, 'cdr', ?)");
  insert_message_ = prepare("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)");
  insert_metadata_ = prepare("INSERT INTO metadata VALUES (1, 5, ?)");
  if (!insert_topic_ || !insert_message_ || !insert_metadata_) return tl::unexpected(Failure());
  return {};
}

namespace fs = std::filesystem;

constexpr std::uint64_t kProgressEvery = 1000;
constexpr const char* kQosKey = "offered_qos_profiles";

/// The topics of a bag, and which one each of the recording's is; several channels may share one.
struct Topics {
  std::vector<Rosbag2Topic> list;  // id - 1 is the index
  std::map<const RecordedTopic*, std::int64_t> ids;
};

Result<Topics> TopicsOf(const McapReader& reader) {
  Topics topics;
  for (const RecordedTopic& recorded : reader.topics()) {
    const Channel& channel = recorded.channel;
    if (channel.message_encoding != "cdr" || recorded.schema.encoding != "ros2msg") {
      return Fail(ErrorCode::kRefused,
                  fmt::format("topic {}: messages in '{}' described by '{}'; rosbag2 takes cdr and "
                              "ros2msg",
                              channel.topic, channel.message_encoding, recorded.schema.encoding));
    }
    auto same = std::find_if(topics.list.begin(), topics.list.end(),
                             [&](const auto& topic) { return topic.name == channel.topic; });
    if (same == topics.list.end()) {
      const auto qos = channel.metadata.find(kQosKey);
      same = topics.list.insert(same,
                                {channel.topic, recorded.schema.name,
                                 qos == channel.metadata.end() ? std::string() : qos->second, 0});
    }
    if (same->type != recorded.schema.name) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("topic {} has two types, {} and {}", channel.topic, same->type,
                              recorded.schema.name));
    }
    topics.ids[&recorded] = same - topics.list.begin() + 1;
  }
  return topics;
}

/// What was written.
struct Copied {
  std::uint64_t messages = 0;
  std::uint64_t start_time = 0;
  std::uint64_t end_time = 0;
  std::vector<std::string> left_out;
};

/// In the order of log times, from which a damaged chunk may only take away.
void Count(Copied& copied, const RecordedMessage& message) {
  if (copied.messages == 0) copied.start_time = message.log_time;
  copied.end_time = std::max(copied.end_time, message.log_time);
  ++copied.messages;
}

Result<Copied> CopyMessages(McapReader& reader, Topics& topics, Rosbag2Database& database,
                            const std::function<void(std::uint64_t)>& progress) {
  reader.Seek(0);
  Copied copied;
  for (;;) {
    const auto message = reader.Next();
    if (!message && message.error().code != ErrorCode::kMalformed) {
      return tl::unexpected(message.error());
    }
    if (!message) {
      copied.left_out.push_back(message.error().text);
      continue;
    }
    if (!*message) return copied;
    const std::int64_t id = topics.ids.at((*message)->topic);
    auto added = database.AddMessage(id, (*message)->log_time, (*message)->data);
    if (!added) return tl::unexpected(added.error());
    ++topics.list[static_cast<std::size_t>(id) - 1].message_count;
    Count(copied, **message);
    if (copied.messages % kProgressEvery == 0) progress(copied.messages);
  }
}

void SetExtent(YAML::Node node, const Copied& copied) {
  node["duration"]["nanoseconds"] = copied.end_time - copied.start_time;
  node["starting_time"]["nanoseconds_since_epoch"] = copied.start_time;
  node["message_count"] = copied.messages;
}

/// What metadata.yaml of a folder with one database says, in version 5, as Humble writes it and all
/// later ones read it. Times are nanoseconds.
std::string MetadataText(const std::string& database, const Copied& copied,
                         const std::vector<Rosbag2Topic>& topics) {
  YAML::Node document;
  YAML::Node bag = document["rosbag2_bagfile_information"];
  bag["version"] = 5;
  bag["storage_identifier"] = "sqlite3";
  SetExtent(bag, copied);
  bag["topics_with_message_count"] = YAML::Node(YAML::NodeType::Sequence);
  for (const Rosbag2Topic& topic : topics) {
    YAML::Node node;
    YAML::Node about = node["topic_metadata"];
    about["name"] = topic.name;
    about["type"] = topic.type;
    about["serialization_format"] = "cdr";
    about["offered_qos_profiles"] = topic.offered_qos;
    node["message_count"] = topic.message_count;
    bag["topics_with_message_count"].push_back(node);
  }
  bag["compression_format"] = "";
  bag["compression_mode"] = "";
  bag["relative_file_paths"].push_back(database);
  YAML::Node file;
  file["path"] = database;
  SetExtent(file, copied);
  bag["files"].push_back(file);
  return YAML::Dump(document) + "\n";
}

Result<std::vector<std::string>> FillFolder(McapReader& reader, Topics& topics,
                                            const fs::path& folder,
                                            const std::function<void(std::uint64_t)>& progress) {
  const std::string name = fs::absolute(folder).lexically_normal().filename().string() + "_0.db3";
  auto database = Rosbag2Database::Create(folder / name);
  if (!database) return tl::unexpected(database.error());
  std::int64_t id = 0;
  for (const Rosbag2Topic& topic : topics.list) {
    if (auto added = database->AddTopic(++id, topic); !added) return tl::unexpected(added.error());
  }
  auto copied = CopyMessages(reader, topics, *database, progress);
  if (!copied) return tl::unexpected(copied.error());
  const std::string metadata = MetadataText(name, *copied, topics.list);
  if (auto committed = database->Commit(metadata); !committed) {
    return tl::unexpected(committed.error());
  }
  return WriteFile(folder / "metadata.yaml", metadata).map([&] {
    return std::move(copied->left_out);
  });
}

}  // namespace

Result<std::vector<std::string>> WriteRosbag2(McapReader& reader, const fs::path& folder,
                                              const std::function<void(std::uint64_t)>& progress) {
  auto topics = TopicsOf(reader);
  if (!topics) return tl::unexpected(topics.error());
  // "bag/" has no name of its own.
  const fs::path target = folder.has_filename() ? folder : folder.parent_path();
  std::error_code error;
  const bool made = fs::create_directory(target, error);
  if (error) return Fail(ErrorCode::kIo, fmt::format("{}: {}", target.string(), error.message()));
  if (!made) return Fail(ErrorCode::kRefused, target.string() + ": exists already");
  auto filled = FillFolder(reader, *topics, target, progress);
  if (!filled) fs::remove_all(target, error);
  return filled;
}

}  // namespace conav::bag
