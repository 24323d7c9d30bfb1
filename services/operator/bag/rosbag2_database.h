#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "common/runtime/result.h"
#include "operator/bag/bytes.h"
#include "operator/bag/rosbag2_metadata.h"

struct sqlite3;
struct sqlite3_stmt;

namespace conav::bag {

/// The SQLite file of a rosbag2 folder, with the tables of Humble (storage schema 3), written once.
/// Nothing is on disk before Commit.
///
/// Errors:  kIo with path and cause (disk full, read-only, ...).
/// Threads: one.
class Rosbag2Database {
 public:
  [[nodiscard]] static Result<Rosbag2Database> Create(const std::filesystem::path& file);

  [[nodiscard]] Result<void> AddTopic(std::int64_t id, const Rosbag2Topic& topic);
  /// `time` in nanoseconds since 1970; `data` is CDR with its encapsulation.
  [[nodiscard]] Result<void> AddMessage(std::int64_t topic_id, std::uint64_t time, ByteSpan data);
  /// With the text of metadata.yaml, which newer readers take from here. Call once, last.
  [[nodiscard]] Result<void> Commit(const std::string& metadata);

 private:
  struct Closer {
    void operator()(sqlite3* connection) const;
    void operator()(sqlite3_stmt* statement) const;
  };

  Rosbag2Database(std::unique_ptr<sqlite3, Closer> connection, std::string file);
  Result<void> Prepare();
  Result<void> Execute(const std::string& sql);
  Error Failure() const;

  std::string file_;
  std::unique_ptr<sqlite3, Closer> connection_;
  std::unique_ptr<sqlite3_stmt, Closer> insert_topic_;
  std::unique_ptr<sqlite3_stmt, Closer> insert_message_;
  std::unique_ptr<sqlite3_stmt, Closer> insert_metadata_;
};

}  // namespace conav::bag
