#include "operator/belief/database.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <algorithm>
#include <utility>

#include "common/runtime/file.h"

namespace conav::operators {
namespace {

struct Finalizer {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, Finalizer>;

void Bind(sqlite3_stmt* statement, int index, const Database::Value& value) {
  if (const auto* number = std::get_if<std::int64_t>(&value)) {
    sqlite3_bind_int64(statement, index, *number);
  } else if (const auto* real = std::get_if<double>(&value)) {
    sqlite3_bind_double(statement, index, *real);
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    sqlite3_bind_text64(statement, index, text->data(), text->size(), SQLITE_STATIC, SQLITE_UTF8);
  } else {
    const auto& blob = std::get<Database::Blob>(value);
    sqlite3_bind_blob64(statement, index, blob.data(), blob.size(), SQLITE_STATIC);
  }
}

Database::Value Column(sqlite3_stmt* statement, int column) {
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, column));
  switch (sqlite3_column_type(statement, column)) {
    case SQLITE_FLOAT:
      return sqlite3_column_double(statement, column);
    case SQLITE_TEXT:
      return std::string(reinterpret_cast<const char*>(sqlite3_column_text(statement, column)),
                         size);
    case SQLITE_BLOB: {
      const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement, column));
      return Database::Blob(bytes, bytes + size);
    }
    default:
      return static_cast<std::int64_t>(sqlite3_column_int64(statement, column));
  }
}

}  // namespace

void Database::Closer::operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }

Database::Database(std::unique_ptr<sqlite3, Closer> connection, std::string file)
    : connection_(std::move(connection)), file_(std::move(file)) {}

Error Database::Failure() const {
  const int code = sqlite3_errcode(connection_.get()) & 0xff;
  if (code == SQLITE_BUSY) {
    return {ErrorCode::kUnavailable, fmt::format("{}: another process holds this file", file_)};
  }
  return {ErrorCode::kIo, fmt::format("{}: {}", file_, sqlite3_errmsg(connection_.get()))};
}

namespace {

/// What people did and where robots are is for the owner only: SQLite gives its log the mode of the
/// file. A failure is SQLite's to report.
void EnsureOwnersOnly(const std::filesystem::path& file) {
  const FileDescriptor made(file, O_RDWR | O_CREAT, 0600);
  if (made.number() >= 0) [[maybe_unused]]
    const int ignored = ::fchmod(made.number(), 0600);
}

}  // namespace

Result<Database> Database::Open(const Options& options) {
  EnsureOwnersOnly(options.file);
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(options.file.c_str(), &raw,
                                   SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
  Database database(std::unique_ptr<sqlite3, Closer>(raw), options.file.string());
  if (code != SQLITE_OK) return tl::unexpected(database.Failure());
  return database.Prepare(options).map([&] { return std::move(database); });
}

Result<void> Database::Prepare(const Options& options) {
  // Exclusive locking makes this process the file's only owner and keeps the WAL index in memory.
  // A cache of 256 KiB: SQLite's own, 2 MiB, takes hours to fill, which looks like a leak.
  for (const char* pragma : {"PRAGMA locking_mode = EXCLUSIVE", "PRAGMA journal_mode = WAL",
                             "PRAGMA synchronous = FULL", "PRAGMA cache_size = -256"}) {
    const auto set = Query(pragma);
    if (!set) return tl::unexpected(set.error());
  }
  const auto check = Query("PRAGMA quick_check(1)");
  if (!check) return tl::unexpected(check.error());
  if (check->empty() || check->front() != Row{std::string("ok")}) {
    return Fail(ErrorCode::kIo, fmt::format("{}: the database is corrupt", file_));
  }
  if (options.size_limit_bytes == 0) return {};
  const auto page_size = Query("PRAGMA page_size");
  if (!page_size) return tl::unexpected(page_size.error());
  const auto pages = options.size_limit_bytes / std::get<std::int64_t>(page_size->front().front());
  const auto limited = Query(fmt::format("PRAGMA max_page_count = {}", pages));
  if (!limited) return tl::unexpected(limited.error());
  return {};
}

Result<void> Database::Execute(const std::string& sql, const Row& arguments) {
  return Query(sql, arguments).map([](const auto&) {});
}

Result<std::vector<Database::Row>> Database::Query(const std::string& sql, const Row& arguments) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(connection_.get(), sql.c_str(), -1, &raw, nullptr) != SQLITE_OK) {
    return tl::unexpected(Failure());
  }
  const Statement statement(raw);
  int index = 0;
  for (const Value& value : arguments) Bind(raw, ++index, value);
  std::vector<Row> rows;
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(raw)) == SQLITE_ROW) {
    Row& row = rows.emplace_back();
    for (int column = 0; column < sqlite3_column_count(raw); ++column) {
      row.push_back(Column(raw, column));
    }
  }
  if (code != SQLITE_DONE) return tl::unexpected(Failure());
  return rows;
}

Result<void> Database::Transaction(const std::function<Result<void>()>& work) {
  if (auto begun = Execute("BEGIN IMMEDIATE"); !begun) return begun;
  Result<void> result = work();
  if (result) result = Execute("COMMIT");
  // Some errors roll back by themselves; a second ROLLBACK would only fail.
  if (!result && sqlite3_get_autocommit(connection_.get()) == 0) {
    [[maybe_unused]] const auto rolled_back = Execute("ROLLBACK");
  }
  return result;
}

}  // namespace conav::operators
