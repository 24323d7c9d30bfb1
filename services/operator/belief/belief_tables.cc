#include <fmt/core.h>
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "operator/belief/database.h"

namespace conav::operators {
namespace {

static_assert(std::endian::native == std::endian::little, "beliefs are stored little-endian");

using nlohmann::json;

constexpr std::int64_t kApplicationId = 0x636f6e76;  // "conv", marks the file as ours
constexpr std::int64_t kSchemaVersion = 5;

/// Version 1.
constexpr const char* kFirstTables[] = {
    "CREATE TABLE beliefs (world TEXT NOT NULL, revision INTEGER NOT NULL, stamp_ns INTEGER NOT "
    "NULL, rows INTEGER NOT NULL, columns INTEGER NOT NULL, cells BLOB NOT NULL, edited_by TEXT "
    "NOT NULL, PRIMARY KEY (world, revision))",
    "CREATE TABLE guidance (robot TEXT PRIMARY KEY, world TEXT NOT NULL, revision INTEGER NOT "
    "NULL, stamp_ns INTEGER NOT NULL, path TEXT NOT NULL, given_by TEXT NOT NULL, belief_revision "
    "INTEGER NOT NULL, answers_snapshot INTEGER NOT NULL, valid_until_ns INTEGER NOT NULL)",
    "CREATE TABLE requests (client TEXT NOT NULL, request_id INTEGER NOT NULL, stamp_ns INTEGER "
    "NOT NULL, world TEXT NOT NULL, body TEXT NOT NULL, accepted INTEGER NOT NULL, reason TEXT NOT "
    "NULL, revision INTEGER NOT NULL, PRIMARY KEY (client, request_id))"};

/// Added by version 2.
constexpr const char* kSecondTables[] = {
    "CREATE TABLE holds (robot TEXT PRIMARY KEY, world TEXT NOT NULL, revision INTEGER NOT NULL, "
    "stamp_ns INTEGER NOT NULL, stopped INTEGER NOT NULL, given_by TEXT NOT NULL, reason TEXT NOT "
    "NULL)",
    "CREATE TABLE alerts (id INTEGER PRIMARY KEY, key TEXT NOT NULL, severity INTEGER NOT NULL, "
    "source TEXT NOT NULL, text TEXT NOT NULL, advice TEXT NOT NULL, raised_s REAL NOT NULL, "
    "newest_s REAL NOT NULL, count INTEGER NOT NULL, acknowledged_by TEXT NOT NULL, "
    "acknowledged_s REAL NOT NULL, shelved_until_s REAL NOT NULL)"};

/// Added by version 3. Rows of an older version count as answered now.
constexpr const char* kThirdColumns[] = {
    "ALTER TABLE alerts ADD COLUMN active INTEGER NOT NULL DEFAULT 0",
    "ALTER TABLE requests ADD COLUMN answered_s REAL NOT NULL DEFAULT 0",
    "UPDATE requests SET answered_s = strftime('%s', 'now')",
    "CREATE INDEX requests_by_time ON requests (answered_s)"};

/// Version 4.
constexpr const char* kRenamedTable = "ALTER TABLE holds RENAME TO stops";

/// Version 5.
constexpr const char* kGoalsTable =
    "CREATE TABLE goals (robot TEXT PRIMARY KEY, world TEXT NOT NULL, stamp_ns INTEGER NOT NULL, "
    "remaining TEXT NOT NULL, reached TEXT NOT NULL, mission TEXT NOT NULL)";

std::int64_t Signed(std::uint64_t value) { return static_cast<std::int64_t>(value); }
std::uint64_t Unsigned(const Database::Value& value) {
  return static_cast<std::uint64_t>(std::get<std::int64_t>(value));
}
std::int64_t Integer(const Database::Value& value) { return std::get<std::int64_t>(value); }
const std::string& Text(const Database::Value& value) { return std::get<std::string>(value); }

json CellsToJson(const std::vector<Cell>& cells) {
  json list = json::array();
  for (const Cell cell : cells) list.push_back({cell.row, cell.column});
  return list;
}

std::vector<Cell> CellsFromJson(const std::string& text) {
  std::vector<Cell> cells;
  for (const json& entry : json::parse(text)) {
    cells.push_back({entry.at(0).get<int>(), entry.at(1).get<int>()});
  }
  return cells;
}

json PlacesToJson(const std::vector<Position>& places) {
  json list = json::array();
  for (const Position place : places) list.push_back({place.x_m, place.y_m});
  return list;
}

std::vector<Position> PlacesFromJson(const std::string& text) {
  std::vector<Position> places;
  for (const json& entry : json::parse(text)) {
    places.push_back({entry.at(0).get<double>(), entry.at(1).get<double>()});
  }
  return places;
}

/// The floats of a grid, row-major; those of more cells than this compressed with zstd, where that
/// is smaller: the disk takes most of the time of an edit.
constexpr std::size_t kMostRawCells = 1 << 16;
constexpr int kFastest = 1;  // level of zstd

Database::Blob GridToBlob(const BeliefGrid& grid) {
  const std::size_t bytes = grid.size() * sizeof(float);
  Database::Blob blob(grid.size() > kMostRawCells ? ZSTD_compressBound(bytes) : bytes);
  if (grid.size() > kMostRawCells) {
    const std::size_t size =
        ZSTD_compress(blob.data(), blob.size(), grid.values().data(), bytes, kFastest);
    blob.resize(ZSTD_isError(size) == 0 && size < bytes ? size : bytes);
  }
  if (blob.size() == bytes && bytes > 0) std::memcpy(blob.data(), grid.values().data(), bytes);
  return blob;
}

Result<BeliefGrid> GridFromBlob(std::int64_t rows, std::int64_t columns,
                                const Database::Blob& blob) {
  constexpr std::int64_t kMostSide = 2048;  // as on the bus
  const auto malformed = [&] {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{} bytes for {} x {} cells", blob.size(), rows, columns));
  };
  if (rows < 1 || rows > kMostSide || columns < 1 || columns > kMostSide) return malformed();
  const std::size_t cells = static_cast<std::size_t>(rows * columns);
  const std::size_t bytes = cells * sizeof(float);
  const bool raw = blob.size() == bytes;
  if (!raw &&
      (cells <= kMostRawCells || ZSTD_getFrameContentSize(blob.data(), blob.size()) != bytes)) {
    return malformed();
  }
  BeliefGrid grid(static_cast<int>(rows), static_cast<int>(columns));
  if (raw) {
    std::memcpy(grid.values().data(), blob.data(), bytes);
  } else if (ZSTD_decompress(grid.values().data(), bytes, blob.data(), blob.size()) != bytes) {
    return malformed();
  }
  const auto is_probability = [](float value) { return value >= 0.0F && value <= 1.0F; };
  if (!std::ranges::all_of(grid.values(), is_probability)) {
    return Fail(ErrorCode::kMalformed, "a cell is no probability from 0 to 1");
  }
  return grid;
}

Result<Belief> BeliefFromRow(const Database::Row& row) {
  auto grid = GridFromBlob(Integer(row[3]), Integer(row[4]), std::get<Database::Blob>(row[5]));
  if (!grid) return tl::unexpected(grid.error());
  return Belief{{Integer(row[2])}, Text(row[0]), Unsigned(row[1]), *std::move(grid), Text(row[6])};
}

Guidance GuidanceFromRow(const Database::Row& row) {
  Guidance guidance;
  guidance.robot = Text(row[0]);
  guidance.world = Text(row[1]);
  guidance.revision = Unsigned(row[2]);
  guidance.stamp = {Integer(row[3])};
  guidance.path = CellsFromJson(Text(row[4]));
  guidance.given_by = Text(row[5]);
  guidance.belief_revision = Unsigned(row[6]);
  guidance.answers_snapshot = Unsigned(row[7]);
  guidance.valid_until = {Integer(row[8])};
  return guidance;
}

double Real(const Database::Value& value) { return std::get<double>(value); }

Alert AlertFromRow(const Database::Row& row) {
  Alert alert;
  alert.id = Unsigned(row[0]);
  alert.condition = {Text(row[1]), static_cast<Severity>(Integer(row[2])), Text(row[3]),
                     Text(row[4]), Text(row[5])};
  alert.raised_s = Real(row[6]);
  alert.newest_s = Real(row[7]);
  alert.count = static_cast<std::uint32_t>(Integer(row[8]));
  alert.acknowledged_by = Text(row[9]);
  alert.acknowledged_s = Real(row[10]);
  alert.shelved_until_s = Real(row[11]);
  alert.active = Integer(row[12]) != 0;
  return alert;
}

/// A row of a type or a text that we did not write: std::get and the JSON parser throw on it.
template <class Read>
auto ReadRow(const char* table, const Database::Row& row, Read&& read)
    -> Result<std::decay_t<decltype(read(row))>> {
  try {
    return read(row);
  } catch (const std::exception& error) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("a row of table {} is damaged: {}", table, error.what()));
  }
}

Result<std::int64_t> Pragma(Database& database, const std::string& name) {
  return database.Query("PRAGMA " + name).map([](const auto& rows) {
    return Integer(rows.at(0).at(0));
  });
}

Result<void> RunAll(Database& database, std::span<const char* const> statements) {
  for (const char* statement : statements) {
    if (auto done = database.Execute(statement); !done) return done;
  }
  return {};
}

/// From `version` (0 = an empty file) to ours.
Result<void> Upgrade(Database& database, std::int64_t version) {
  return database.Transaction([&]() -> Result<void> {
    if (version < 1) {
      if (auto made = RunAll(database, kFirstTables); !made) return made;
    }
    if (version < 2) {
      if (auto made = RunAll(database, kSecondTables); !made) return made;
    }
    if (version < 3) {
      if (auto made = RunAll(database, kThirdColumns); !made) return made;
    }
    if (version < 4) {
      if (auto renamed = database.Execute(kRenamedTable); !renamed) return renamed;
    }
    if (auto made = database.Execute(kGoalsTable); !made) return made;
    for (const std::string& mark : {fmt::format("application_id = {}", kApplicationId),
                                    fmt::format("user_version = {}", kSchemaVersion)}) {
      if (auto set = database.Execute("PRAGMA " + mark); !set) return set;
    }
    return {};
  });
}

json EditBody(const EditRequest& edit) {
  json edits = json::array();
  for (const CellEdit& e : edit.edits) edits.push_back({e.cell.row, e.cell.column, e.wall});
  return {{"kind", "edit"}, {"base_revision", edit.base_revision}, {"edits", edits}};
}

json GuideBody(const GuideRequest& guide) {
  return {{"kind", "guide"},
          {"robot", guide.robot},
          {"path", CellsToJson(guide.path)},
          {"answers_snapshot", guide.answers_snapshot},
          {"valid_for_s", guide.valid_for_s}};
}

struct BodyOf {
  json operator()(const EditRequest& edit) const { return EditBody(edit); }
  json operator()(const GuideRequest& guide) const { return GuideBody(guide); }
  json operator()(const AnswerRequest& answer) const {
    return {{"kind", "answer"}, {"robot", answer.robot}, {"snapshot", answer.snapshot}};
  }
  json operator()(const StopRequest& stop) const {
    return {{"kind", "stop"}, {"robots", stop.robots}, {"reason", stop.reason}};
  }
  json operator()(const ResumeRequest& resume) const {
    return {{"kind", "resume"}, {"robots", resume.robots}};
  }
  json operator()(const TakeControlRequest& take) const {
    return {{"kind", "take_control"},
            {"robots", take.robots},
            {"reason", take.reason},
            {"ask", take.ask}};
  }
  json operator()(const ReleaseControlRequest& release) const {
    return {
        {"kind", "release_control"}, {"robots", release.robots}, {"to_client", release.to_client}};
  }
  json operator()(const AcknowledgeRequest& acknowledge) const {
    return {{"kind", "acknowledge"}, {"alert", acknowledge.alert}};
  }
  json operator()(const ShelveRequest& shelve) const {
    return {{"kind", "shelve"}, {"alert", shelve.alert}, {"duration_s", shelve.duration_s}};
  }
  json operator()(const FinishRequest&) const { return {{"kind", "finish"}}; }
  json operator()(const GoalsRequest& goals) const {
    return {{"kind", "goals"},
            {"robot", goals.robot},
            {"add", PlacesToJson(goals.add)},
            {"remove", PlacesToJson(goals.remove)}};
  }
  json operator()(const NoteRequest& note) const { return {{"kind", "note"}, {"text", note.text}}; }
  json operator()(const DriveRequest& drive) const {
    return {{"kind", "drive"}, {"robot", drive.robot}};
  }
  json operator()(const SelectRequest& select) const {
    return {{"kind", "select"}, {"robot", select.robot}};
  }
};

StopOrder StopFromRow(const Database::Row& row) {
  return {{Integer(row[3])},    Text(row[1]), Text(row[0]), Unsigned(row[2]),
          Integer(row[4]) != 0, Text(row[5]), Text(row[6])};
}

KeptGoals GoalsFromRow(const Database::Row& row) {
  KeptGoals kept;
  kept.goals.robot = Text(row[0]);
  kept.goals.world = Text(row[1]);
  kept.goals.stamp = {Integer(row[2])};
  kept.goals.left = PlacesFromJson(Text(row[3]));
  kept.goals.reached = PlacesFromJson(Text(row[4]));
  kept.goals.total = static_cast<std::uint32_t>(kept.goals.left.size() + kept.goals.reached.size());
  kept.mission = Text(row[5]);
  return kept;
}

}  // namespace

std::string RequestBody(const OperatorRequest& request) {
  const json body = std::visit(BodyOf{}, request.body);
  // Texts come from other processes and need not be UTF-8; they must not stop the service.
  return body.dump(-1, ' ', false, json::error_handler_t::replace);
}

Result<void> EnsureSchema(Database& database) {
  const auto tables = database.Query("SELECT count(*) FROM sqlite_master");
  if (!tables) return tl::unexpected(tables.error());
  if (Integer(tables->at(0).at(0)) == 0) return Upgrade(database, 0);
  const auto application = Pragma(database, "application_id");
  if (!application) return tl::unexpected(application.error());
  const auto version = Pragma(database, "user_version");
  if (!version) return tl::unexpected(version.error());
  if (*application != kApplicationId) {
    return Fail(ErrorCode::kMalformed, "this is a database of another program");
  }
  if (*version >= 1 && *version < kSchemaVersion) return Upgrade(database, *version);
  if (*version != kSchemaVersion) {
    return Fail(ErrorCode::kMalformed, fmt::format("written by another version: schema {}, not {}",
                                                   *version, kSchemaVersion));
  }
  return {};
}

Result<std::map<std::string, Belief>> LoadBeliefs(Database& database) {
  const auto rows = database.Query(
      "SELECT world, revision, stamp_ns, rows, columns, cells, edited_by FROM beliefs "
      "ORDER BY world, revision");
  if (!rows) return tl::unexpected(rows.error());
  std::map<std::string, Belief> beliefs;
  for (const Database::Row& row : *rows) {
    auto belief = ReadRow("beliefs", row, [](const auto& r) { return BeliefFromRow(r); });
    if (!belief) return tl::unexpected(belief.error());
    if (!*belief) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("belief of world {}: {}", Text(row[0]), belief->error().text));
    }
    beliefs[Text(row[0])] = **std::move(belief);  // the newest comes last
  }
  return beliefs;
}

Result<std::map<std::string, Guidance>> LoadGuidance(Database& database) {
  const auto rows = database.Query(
      "SELECT robot, world, revision, stamp_ns, path, given_by, belief_revision, answers_snapshot, "
      "valid_until_ns FROM guidance");
  if (!rows) return tl::unexpected(rows.error());
  std::map<std::string, Guidance> guidance;
  for (const Database::Row& row : *rows) {
    auto loaded = ReadRow("guidance", row, [](const auto& r) { return GuidanceFromRow(r); });
    if (!loaded) return tl::unexpected(loaded.error());
    const std::string robot = loaded->robot;
    guidance[robot] = *std::move(loaded);
  }
  return guidance;
}

Result<std::map<std::string, StopOrder>> LoadStops(Database& database) {
  const auto rows = database.Query(
      "SELECT robot, world, revision, stamp_ns, stopped, given_by, reason FROM stops");
  if (!rows) return tl::unexpected(rows.error());
  std::map<std::string, StopOrder> stops;
  for (const Database::Row& row : *rows) {
    auto stop = ReadRow("stops", row, [](const auto& r) { return StopFromRow(r); });
    if (!stop) return tl::unexpected(stop.error());
    stops[stop->robot] = *stop;
  }
  return stops;
}

Result<std::map<std::string, KeptGoals>> LoadGoals(Database& database) {
  const auto rows =
      database.Query("SELECT robot, world, stamp_ns, remaining, reached, mission FROM goals");
  if (!rows) return tl::unexpected(rows.error());
  std::map<std::string, KeptGoals> goals;
  for (const Database::Row& row : *rows) {
    auto kept = ReadRow("goals", row, [](const auto& r) { return GoalsFromRow(r); });
    if (!kept) return tl::unexpected(kept.error());
    const std::string robot = kept->goals.robot;
    goals[robot] = *std::move(kept);
  }
  return goals;
}

Result<std::vector<Alert>> LoadAlerts(Database& database) {
  const auto rows = database.Query(
      "SELECT id, key, severity, source, text, advice, raised_s, newest_s, count, acknowledged_by, "
      "acknowledged_s, shelved_until_s, active FROM alerts ORDER BY id");
  if (!rows) return tl::unexpected(rows.error());
  std::vector<Alert> alerts;
  for (const Database::Row& row : *rows) {
    auto alert = ReadRow("alerts", row, [](const auto& r) { return AlertFromRow(r); });
    if (!alert) return tl::unexpected(alert.error());
    alerts.push_back(*std::move(alert));
  }
  return alerts;
}

Result<std::optional<BeliefGrid>> LoadInitialMap(Database& database, const std::string& world) {
  const auto rows = database.Query(
      "SELECT rows, columns, cells FROM beliefs WHERE world = ? AND revision = 0", {world});
  if (!rows) return tl::unexpected(rows.error());
  if (rows->empty()) return std::optional<BeliefGrid>();
  const Database::Row& row = rows->front();
  return GridFromBlob(Integer(row[0]), Integer(row[1]), std::get<Database::Blob>(row[2]))
      .map([](BeliefGrid&& grid) { return std::optional<BeliefGrid>(std::move(grid)); });
}

Result<void> SaveBelief(Database& database, const Belief& belief) {
  auto saved = database.Execute("INSERT INTO beliefs VALUES (?, ?, ?, ?, ?, ?, ?)",
                                {belief.world, Signed(belief.revision), belief.stamp.nanoseconds,
                                 std::int64_t{belief.wall_probability.rows()},
                                 std::int64_t{belief.wall_probability.columns()},
                                 GridToBlob(belief.wall_probability), belief.edited_by});
  if (!saved) return saved;
  return database.Execute("DELETE FROM beliefs WHERE world = ? AND revision > 0 AND revision < ?",
                          {belief.world, Signed(belief.revision)});
}

Result<void> SaveGuidance(Database& database, const Guidance& guidance) {
  return database.Execute(
      "INSERT OR REPLACE INTO guidance VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
      {guidance.robot, guidance.world, Signed(guidance.revision), guidance.stamp.nanoseconds,
       CellsToJson(guidance.path).dump(), guidance.given_by, Signed(guidance.belief_revision),
       Signed(guidance.answers_snapshot), guidance.valid_until.nanoseconds});
}

Result<void> SaveStop(Database& database, const StopOrder& stop) {
  return database.Execute("INSERT OR REPLACE INTO stops VALUES (?, ?, ?, ?, ?, ?, ?)",
                          {stop.robot, stop.world, Signed(stop.revision), stop.stamp.nanoseconds,
                           std::int64_t{stop.stopped}, stop.given_by, stop.reason});
}

Result<void> SaveGoals(Database& database, const KeptGoals& kept) {
  return database.Execute("INSERT OR REPLACE INTO goals VALUES (?, ?, ?, ?, ?, ?)",
                          {kept.goals.robot, kept.goals.world, kept.goals.stamp.nanoseconds,
                           PlacesToJson(kept.goals.left).dump(),
                           PlacesToJson(kept.goals.reached).dump(), kept.mission});
}

Result<void> SaveAlert(Database& database, const Alert& alert) {
  const Condition& condition = alert.condition;
  return database.Execute(
      "INSERT OR REPLACE INTO alerts VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      {Signed(alert.id), condition.key, static_cast<std::int64_t>(condition.severity),
       condition.source, condition.text, condition.advice, alert.raised_s, alert.newest_s,
       std::int64_t{alert.count}, alert.acknowledged_by, alert.acknowledged_s,
       alert.shelved_until_s, std::int64_t{alert.active}});
}

Result<void> RemoveAlert(Database& database, std::uint64_t id) {
  return database.Execute("DELETE FROM alerts WHERE id = ?", {Signed(id)});
}

Result<void> SaveRequest(Database& database, const OperatorRequest& request,
                         const OperatorReply& reply) {
  return database.Execute(
      "INSERT INTO requests VALUES (?, ?, ?, ?, ?, ?, ?, ?, strftime('%s', 'now'))",
      {request.client, Signed(request.request_id), request.stamp.nanoseconds, request.world,
       RequestBody(request), std::int64_t{reply.accepted}, reply.reason, Signed(reply.revision)});
}

Result<std::int64_t> RemoveRequests(Database& database, double wall_s, std::int64_t most) {
  const auto removed = database.Query(
      "DELETE FROM requests WHERE rowid IN (SELECT rowid FROM requests WHERE answered_s < ? "
      "ORDER BY answered_s LIMIT ?) RETURNING 1",
      {wall_s, most});
  if (!removed) return tl::unexpected(removed.error());
  return static_cast<std::int64_t>(removed->size());
}

Result<std::int64_t> CountRequests(Database& database) {
  const auto rows = database.Query("SELECT count(*) FROM requests", {});
  if (!rows) return tl::unexpected(rows.error());
  return ReadRow("requests", rows->front(),
                 [](const Database::Row& row) { return Integer(row[0]); });
}

Result<std::optional<LoggedRequest>> FindRequest(Database& database, const std::string& client,
                                                 std::uint64_t request_id) {
  const auto rows = database.Query(
      "SELECT world, body, accepted, reason, revision FROM requests WHERE client = ? AND "
      "request_id = ?",
      {client, Signed(request_id)});
  if (!rows) return tl::unexpected(rows.error());
  if (rows->empty()) return std::optional<LoggedRequest>();
  return ReadRow("requests", rows->front(), [&](const Database::Row& row) {
    return std::optional<LoggedRequest>(
        {Text(row[0]),
         Text(row[1]),
         {client, request_id, Integer(row[2]) != 0, Text(row[3]), Unsigned(row[4])}});
  });
}

}  // namespace conav::operators
