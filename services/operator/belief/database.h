#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "operator/belief/alert.h"

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

/// The tables of the operator's database, and the values that go into them.
///
///   beliefs(world, revision, stamp_ns, rows, columns, cells, edited_by)
///     revision 0 and the newest
///   guidance(robot, world, revision, stamp_ns, path, ...)
///     the newest of each robot
///   stops(robot, world, revision, stamp_ns, stopped, given_by, reason)
///     the newest of each robot that was ever stopped
///   goals(robot, world, stamp_ns, remaining, reached, mission)
///     of robots whose goals the service keeps; the newest of each
///   alerts(id, key, severity, source, text, advice, raised_s, newest_s, count, ..., active)
///     all that are not over and acknowledged, and the newest of the others
///   requests(client, request_id, stamp_ns, world, body, accepted, reason, revision, answered_s)
///     of the last day or so; answered_s: wall time, s since 1970
///
/// `cells` is row-major float32, little-endian; `path`, `body`, `remaining` and `reached` are JSON, for people with
/// sqlite3.
namespace conav::operators {

/// A request that was answered: what was asked, and the reply.
struct LoggedRequest {
  std::string world;
  std::string body;  // as RequestBody() gives it
  OperatorReply reply;
};

/// The goals of a robot that does not keep them, and the mission that they began with.
struct KeptGoals {
  RobotGoals goals;
  std::string mission;  // empty = none
  bool operator==(const KeptGoals&) const = default;
};

/// What is asked, as JSON: two requests with equal text ask for the same thing.
std::string RequestBody(const OperatorRequest& request);

/// Makes the tables in an empty file, and those that an older version of conav did not have.
/// Errors: kMalformed for a file of another program or of a
/// version that this one does not know.
[[nodiscard]] Result<void> EnsureSchema(Database& database);

/// The newest belief of each world, by world; the newest guidance of each robot, by robot. Errors:
/// kMalformed names the row.
[[nodiscard]] Result<std::map<std::string, Belief>> LoadBeliefs(Database& database);
[[nodiscard]] Result<std::map<std::string, Guidance>> LoadGuidance(Database& database);

/// By robot.
[[nodiscard]] Result<std::map<std::string, StopOrder>> LoadStops(Database& database);
[[nodiscard]] Result<std::map<std::string, KeptGoals>> LoadGoals(Database& database);

/// By id.
[[nodiscard]] Result<std::vector<Alert>> LoadAlerts(Database& database);

/// The initial map of `world`; nothing when the world is not known.
[[nodiscard]] Result<std::optional<BeliefGrid>> LoadInitialMap(Database& database,
                                                               const std::string& world);

[[nodiscard]] Result<void> SaveBelief(Database& database, const Belief& belief);
[[nodiscard]] Result<void> SaveGuidance(Database& database, const Guidance& guidance);
[[nodiscard]] Result<void> SaveStop(Database& database, const StopOrder& stop);
[[nodiscard]] Result<void> SaveGoals(Database& database, const KeptGoals& kept);
[[nodiscard]] Result<void> SaveAlert(Database& database, const Alert& alert);
[[nodiscard]] Result<void> RemoveAlert(Database& database, std::uint64_t id);
[[nodiscard]] Result<void> SaveRequest(Database& database, const OperatorRequest& request,
                                       const OperatorReply& reply);

/// The oldest that were answered before `wall_s`, at most `most`. How many.
[[nodiscard]] Result<std::int64_t> RemoveRequests(Database& database, double wall_s,
                                                  std::int64_t most);

[[nodiscard]] Result<std::int64_t> CountRequests(Database& database);
[[nodiscard]] Result<std::optional<LoggedRequest>> FindRequest(Database& database,
                                                               const std::string& client,
                                                               std::uint64_t request_id);

}  // namespace conav::operators
