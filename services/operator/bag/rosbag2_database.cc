#include "operator/bag/rosbag2_database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <string_view>
#include <utility>

namespace conav::bag {
namespace {

// The file is made anew and of no use before it is complete, so that nothing need be undone.
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

void Bind(sqlite3_stmt* statement, int index, std::string_view text) {
  sqlite3_bind_text64(statement, index, text.data(), text.size(), SQLITE_STATIC, SQLITE_UTF8);
}

/// Runs a prepared statement that gives no rows. False when it fails.
bool Run(sqlite3_stmt* statement) {
  const bool done = sqlite3_step(statement) == SQLITE_DONE;
  sqlite3_reset(statement);
  return done;
}

}  // namespace

void Rosbag2Database::Closer::operator()(sqlite3* connection) const {
  sqlite3_close_v2(connection);
}
void Rosbag2Database::Closer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Rosbag2Database::Rosbag2Database(std::unique_ptr<sqlite3, Closer> connection, std::string file)
    : file_(std::move(file)), connection_(std::move(connection)) {}

Error Rosbag2Database::Failure() const {
  return {ErrorCode::kIo, fmt::format("{}: {}", file_, sqlite3_errmsg(connection_.get()))};
}

Result<Rosbag2Database> Rosbag2Database::Create(const std::filesystem::path& file) {
  sqlite3* raw = nullptr;
  const int code =
      sqlite3_open_v2(file.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  Rosbag2Database database(std::unique_ptr<sqlite3, Closer>(raw), file.string());
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
    return std::unique_ptr<sqlite3_stmt, Closer>(statement);
  };
  insert_topic_ = prepare("INSERT INTO topics VALUES (?, ?, ?, 'cdr', ?)");
  insert_message_ = prepare("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)");
  insert_metadata_ = prepare("INSERT INTO metadata VALUES (1, 5, ?)");
  if (!insert_topic_ || !insert_message_ || !insert_metadata_) return tl::unexpected(Failure());
  return {};
}

Result<void> Rosbag2Database::AddTopic(std::int64_t id, const Rosbag2Topic& topic) {
  sqlite3_stmt* statement = insert_topic_.get();
  sqlite3_bind_int64(statement, 1, id);
  Bind(statement, 2, topic.name);
  Bind(statement, 3, topic.type);
  Bind(statement, 4, topic.offered_qos);
  if (!Run(statement)) return tl::unexpected(Failure());
  return {};
}

Result<void> Rosbag2Database::AddMessage(std::int64_t topic_id, std::uint64_t time, ByteSpan data) {
  sqlite3_stmt* statement = insert_message_.get();
  sqlite3_bind_int64(statement, 1, topic_id);
  sqlite3_bind_int64(statement, 2, static_cast<std::int64_t>(time));
  sqlite3_bind_blob64(statement, 3, data.data(), data.size(), SQLITE_STATIC);
  if (!Run(statement)) return tl::unexpected(Failure());
  return {};
}

Result<void> Rosbag2Database::Commit(const std::string& metadata) {
  Bind(insert_metadata_.get(), 1, metadata);
  if (!Run(insert_metadata_.get())) return tl::unexpected(Failure());
  return Execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC); COMMIT;");
}

}  // namespace conav::bag
