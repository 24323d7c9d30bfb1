#include "launcher/soak_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "operator/belief/database.h"

namespace conav::launcher {
namespace {

using nlohmann::json;

constexpr std::chrono::milliseconds kControlStep{250};
constexpr double kStillMps = 0.01;
constexpr double kSamePlaceM = 0.02;

/// What an edit gives a cell.
float ValueOf(bool wall) { return wall ? 1.0F : 0.0F; }

}  // namespace

void Invariants::Violated(std::string text) {
  ++count_;
  const bool is_known = std::ranges::find(violations_, text) != violations_.end();
  if (!is_known && violations_.size() < kMostTexts) violations_.push_back(std::move(text));
}

bool Invariants::Stands(const RobotState& state) {
  return state.stopped && std::abs(state.speed_mps) < kStillMps &&
         std::abs(state.yaw_rate_rps) < kStillMps;
}

std::uint64_t Invariants::revision(const std::string& world) const {
  const auto found = edit_of_.find(world);
  if (found == edit_of_.end() || found->second.empty()) return 0;
  return found->second.rbegin()->first;
}

void Invariants::See(const PlannerLease& lease, Clock::TimePoint now) {
  for (const PlannerLease::Held& held : lease.holds) {
    Holder& holder = robots_[held.robot].holder;
    const std::pair rank{held.lease_epoch, lease.instance};
    if (rank > std::pair{holder.lease_epoch, holder.instance}) {
      holder = {held.lease_epoch, lease.instance, now};
    } else if (lease.instance != holder.instance && now - holder.since > kLeaseLag) {
      Violated(fmt::format("{} still holds {} with lease epoch {}; {} holds epoch {}",
                           lease.instance, held.robot, held.lease_epoch, holder.instance,
                           holder.lease_epoch));
    }
  }
}

void Invariants::See(const RobotCommand& command, const std::string& writer) {
  constexpr std::size_t kRemembered = 64;
  Robot& robot = robots_[command.robot];
  auto& expiry = robot.expiry;
  SimTime& expires_at = expiry[{command.lease_epoch, command.sequence_number}];
  expires_at = std::max(expires_at, command.expires_at);  // a repeat may be the one that it took
  if (expiry.size() > kRemembered) expiry.erase(expiry.begin());
  const std::string& first = robot.writers.try_emplace(command.lease_epoch, writer).first->second;
  if (first != writer) {
    Violated(fmt::format("two processes command {} with lease epoch {}", command.robot,
                         command.lease_epoch));
  }
  if (robot.writers.size() > kRemembered) robot.writers.erase(robot.writers.begin());
}

void Invariants::See(const RobotState& state) {
  Robot& robot = robots_[state.robot];
  const auto expiry = robot.expiry.find({state.lease_epoch, state.command_sequence_number});
  if (state.command_outcome == CommandOutcome::kRunning && expiry != robot.expiry.end() &&
      state.stamp > expiry->second + kControlStep) {
    Violated(fmt::format("{} carries out command {} at {:.2f} s, which expired at {:.2f} s",
                         state.robot, state.command_sequence_number, state.stamp.ToSeconds(),
                         expiry->second.ToSeconds()));
  }
  if (robot.held && !state.stopped) {
    Violated(fmt::format("{} was resumed by nobody, stop revision {}", state.robot,
                         state.stop_revision));
    robot.held = false;
  }
  if (robot.state) {
    const RobotState& before = *robot.state;
    if (state.lease_epoch < before.lease_epoch) {
      Violated(fmt::format("{}'s lease epoch went back from {} to {}", state.robot,
                           before.lease_epoch, state.lease_epoch));
    }
    const double moved_m = std::hypot(state.position.x_m - before.position.x_m,
                                      state.position.y_m - before.position.y_m);
    if (Stands(before) && state.stopped && state.stop_revision == before.stop_revision &&
        (moved_m > kSamePlaceM || state.cell_moves > before.cell_moves)) {
      Violated(fmt::format("{} moved {:.2f} m while it was stopped", state.robot, moved_m));
    }
  }
  robot.state = state;
}

void Invariants::See(const Belief& belief) {
  std::uint64_t& published = published_[belief.world];
  if (belief.revision < published) {
    Violated(fmt::format("the map of {} went back from revision {} to {}", belief.world, published,
                         belief.revision));
  }
  published = belief.revision;
  const auto& edits = edit_of_[belief.world];
  const auto found = edits.find(belief.revision);
  if (found == edits.end()) return;
  for (const CellEdit& edit : edits_[found->second].edit.edits) {
    if (belief.wall_probability[edit.cell] == ValueOf(edit.wall)) continue;
    Violated(fmt::format("revision {} of the map of {} lacks the accepted edit of cell {}",
                         belief.revision, belief.world, edit.cell));
  }
}

void Invariants::See(AcceptedEdit edit) {
  if (edit.revision != edit.edit.base_revision + 1 || edit.revision <= edit.known_revision) {
    Violated(fmt::format(
        "edit {} of {} got revision {}: it was based on {}, and {} was accepted "
        "before it was sent",
        edit.request_id, edit.client, edit.revision, edit.edit.base_revision, edit.known_revision));
  }
  const bool is_new = edit_of_[edit.world].emplace(edit.revision, edits_.size()).second;
  if (!is_new) {
    Violated(fmt::format("two edits of {} got revision {}", edit.world, edit.revision));
  }
  edits_.push_back(std::move(edit));
}

namespace {

using operators::Database;

struct StoredEdit {
  std::string client;
  std::uint64_t request_id = 0;
  std::string world;
  std::uint64_t revision = 0;
  json edits;  // [row, column, wall]
};

Result<std::vector<StoredEdit>> LoadEdits(Database& database) {
  const auto rows = database.Query(
      "SELECT client, request_id, world, revision, body FROM requests WHERE accepted = 1 ORDER BY "
      "world, revision");
  if (!rows) return tl::unexpected(rows.error());
  std::vector<StoredEdit> edits;
  for (const Database::Row& row : *rows) {
    json body = json::parse(std::get<std::string>(row[4]), nullptr, false);
    if (!body.is_object())
      return Fail(ErrorCode::kMalformed, "a request in the database is no JSON");
    if (body["kind"] != "edit") continue;
    const auto number = [&](std::size_t column) {
      return static_cast<std::uint64_t>(std::get<std::int64_t>(row[column]));
    };
    edits.push_back({std::get<std::string>(row[0]), number(1), std::get<std::string>(row[2]),
                     number(3), std::move(body["edits"])});
  }
  return edits;
}

/// Checks that `stored` has what was acknowledged; the rest of it is other clients'.
void CompareAcknowledged(const std::vector<StoredEdit>& stored, Invariants& invariants) {
  std::map<std::pair<std::string, std::uint64_t>, std::uint64_t> revisions;
  for (const StoredEdit& edit : stored) revisions[{edit.client, edit.request_id}] = edit.revision;
  for (const AcceptedEdit& edit : invariants.edits()) {
    const auto found = revisions.find({edit.client, edit.request_id});
    if (found != revisions.end() && found->second == edit.revision) continue;
    invariants.Violated(fmt::format(
        "edit {} of {} was accepted as revision {}; the database {}", edit.request_id, edit.client,
        edit.revision,
        found == revisions.end() ? "does not have it" : fmt::format("has {}", found->second)));
  }
}

Result<void> Replay(Database& database, const std::vector<StoredEdit>& stored,
                    Invariants& invariants) {
  const auto beliefs = operators::LoadBeliefs(database);
  if (!beliefs) return tl::unexpected(beliefs.error());
  for (const auto& [world, belief] : *beliefs) {
    const auto initial = operators::LoadInitialMap(database, world);
    if (!initial) return tl::unexpected(initial.error());
    BeliefGrid map = initial->value_or(BeliefGrid{});
    std::uint64_t revision = 0;
    for (const StoredEdit& edit : stored) {
      if (edit.world != world) continue;
      if (revision == 0 && edit.revision > 1) break;  // the first are no longer kept
      if (edit.revision != ++revision) {
        invariants.Violated(
            fmt::format("the database has revision {} of the map of {} where {} "
                        "comes next",
                        edit.revision, world, revision));
        revision = edit.revision;
      }
      for (const json& cell : edit.edits) {
        map[Cell{cell[0].get<int>(), cell[1].get<int>()}] = ValueOf(cell[2].get<bool>());
      }
    }
    if (revision == 0 && belief.revision > 0) continue;
    if (revision != belief.revision || !(map == belief.wall_probability)) {
      invariants.Violated(
          fmt::format("the stored edits of {} lead to revision {} of its map and "
                      "not to the stored one, {}",
                      world, revision, belief.revision));
    }
  }
  return {};
}

}  // namespace

void CheckJournal(const std::filesystem::path& database, Invariants& invariants) {
  auto opened = Database::Open({database, 0});
  Result<void> checked;
  if (!opened) {
    checked = tl::unexpected(opened.error());
  } else if (const auto stored = LoadEdits(*opened); !stored) {
    checked = tl::unexpected(stored.error());
  } else {
    CompareAcknowledged(*stored, invariants);
    checked = Replay(*opened, *stored, invariants);
  }
  if (!checked) invariants.Violated("the operator's database: " + checked.error().text);
}

std::optional<ProcessSample> SampleProcess(std::string process, pid_t pid, double at_s) {
  ProcessSample sample{std::move(process), pid, at_s};
  const std::string folder = fmt::format("/proc/{}", pid);
  std::ifstream status(folder + "/status");
  for (std::string word; status >> word;) {
    if (word == "VmRSS:") {
      status >> sample.rss_mb;  // kB
      sample.rss_mb /= 1024.0;
    } else if (word == "Threads:") {
      status >> sample.threads;
    }
  }
  std::error_code gone;
  const std::filesystem::directory_iterator open(folder + "/fd", gone);
  if (gone || sample.rss_mb == 0.0) return std::nullopt;
  sample.fds = static_cast<int>(std::distance(begin(open), end(open)));
  return sample;
}

std::optional<double> RssSlope(std::span<const ProcessSample> samples) {
  struct Life {
    double count = 0.0;
    double at_s = 0.0;
    double rss_mb = 0.0;
  };
  std::map<pid_t, Life> lives;  // sums, then means
  for (const ProcessSample& sample : samples) {
    Life& life = lives[sample.pid];
    ++life.count;
    life.at_s += sample.at_s;
    life.rss_mb += sample.rss_mb;
  }
  for (auto& [pid, life] : lives) {
    life.at_s /= life.count;
    life.rss_mb /= life.count;
  }
  double numerator = 0.0;
  double denominator = 0.0;
  for (const ProcessSample& sample : samples) {
    const Life& life = lives[sample.pid];
    const double at_h = (sample.at_s - life.at_s) / 3600.0;
    numerator += at_h * (sample.rss_mb - life.rss_mb);
    denominator += at_h * at_h;
  }
  if (denominator <= 0.0) return std::nullopt;
  return numerator / denominator;
}

}  // namespace conav::launcher
