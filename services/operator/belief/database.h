#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "common/runtime/result.h"

struct sqlite3;

namespace conav::operators {

/// One SQLite file, held by this process alone, in which a committed transaction survives the loss
/// of power (WAL, synchronous=FULL: one fsync of the log for each commit).
///
/// Errors:  kIo with file and cause (disk full, read-only, I/O error), kUnavailable when another
///          process holds the file. A failed transaction leaves the file as it was, and a later one
///          may succeed.
/// Threads: not synchronised; one owner. Every call blocks on the disk.
class Database {
 public:
  using Blob = std::vector<std::uint8_t>;
  using Value = std::variant<std::int64_t, double, std::string, Blob>;
  using Row = std::vector<Value>;

  struct Options {
    std::filesystem::path file;
    /// Refuse to grow beyond this size; 0 = until the disk is full.
    std::int64_t size_limit_bytes = 0;
  };

  /// Opens or creates the file and checks it ("quick_check"); the file's folder must exist.
  static Result<Database> Open(const Options& options);

  [[nodiscard]] Result<void> Execute(const std::string& sql, const Row& arguments = {});
  [[nodiscard]] Result<std::vector<Row>> Query(const std::string& sql, const Row& arguments = {});

  /// Runs `work` and commits; rolls back when it, or the commit, fails.
  [[nodiscard]] Result<void> Transaction(const std::function<Result<void>()>& work);

 private:
  struct Closer {
    void operator()(sqlite3* connection) const;
  };

  Database(std::unique_ptr<sqlite3, Closer> connection, std::string file);
  Result<void> Prepare(const Options& options);
  Error Failure() const;

  std::unique_ptr<sqlite3, Closer> connection_;
  std::string file_;
};

}  // namespace conav::operators
