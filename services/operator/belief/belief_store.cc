#include "operator/belief/belief_store.h"

#include <fmt/core.h>

#include <set>
#include <utility>

#include "operator/belief/database.h"

namespace conav::operators {
namespace {

std::string MapSize(const BeliefGrid& map) {
  return fmt::format("the map of {} x {} cells", map.rows(), map.columns());
}

Result<void> CheckEditedCells(const BeliefGrid& map, const std::vector<CellEdit>& edits) {
  std::set<Cell> cells;
  for (const CellEdit& edit : edits) {
    if (!map.Contains(edit.cell)) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("cell {} lies outside of {}", edit.cell, MapSize(map)));
    }
    if (map.OnBorder(edit.cell)) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("cell {} is on the border of {}, which cannot be edited", edit.cell,
                              MapSize(map)));
    }
    if (!cells.insert(edit.cell).second) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("cell {} is edited twice in one request", edit.cell));
    }
  }
  return {};
}

Result<void> CheckPath(const BeliefGrid& map, const std::vector<Cell>& path, int limit) {
  if (path.size() > static_cast<std::size_t>(limit)) {
    return Fail(ErrorCode::kRefused,
                fmt::format("the path has {} cells; the limit is {}", path.size(), limit));
  }
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!map.Contains(path[i])) {
      return Fail(ErrorCode::kRefused, fmt::format("path cell {} (index {}) lies outside of {}",
                                                   path[i], i, MapSize(map)));
    }
    if (i > 0 && !AreNeighbours(path[i - 1], path[i])) {
      return Fail(ErrorCode::kRefused,
                  fmt::format("path cells {} and {} (index {}) are not 4-neighbours", path[i - 1],
                              path[i], i));
    }
  }
  return {};
}

}  // namespace

Result<Belief> ApplyEdit(const Belief& current, const EditRequest& request,
                         const std::string& client, SimTime now) {
  if (request.edits.empty()) return Fail(ErrorCode::kRefused, "the edit names no cell");
  if (request.base_revision != current.revision) {
    return Fail(ErrorCode::kRefused,
                fmt::format("the edit is based on revision {} of world {}; the current one is {}",
                            request.base_revision, current.world, current.revision));
  }
  if (auto checked = CheckEditedCells(current.wall_probability, request.edits); !checked) {
    return tl::unexpected(checked.error());
  }
  Belief edited = current;
  for (const CellEdit& edit : request.edits) {
    edited.wall_probability[edit.cell] = edit.wall ? 1.0F : 0.0F;
  }
  edited.stamp = now;
  edited.revision = current.revision + 1;
  edited.edited_by = client;
  return edited;
}

Result<Guidance> MakeGuidance(const Belief& belief, const GuideRequest& request,
                              std::uint64_t last_revision, const std::string& client, SimTime now,
                              const GuidanceLimits& limits) {
  if (!(request.valid_for_s > 0.0 && request.valid_for_s <= limits.valid_for_s)) {
    return Fail(ErrorCode::kRefused, fmt::format("valid_for = {} s is not in (0, {}]",
                                                 request.valid_for_s, limits.valid_for_s));
  }
  if (auto checked = CheckPath(belief.wall_probability, request.path, limits.path_cells);
      !checked) {
    return tl::unexpected(checked.error());
  }
  Guidance guidance;
  guidance.stamp = now;
  guidance.world = belief.world;
  guidance.robot = request.robot;
  guidance.revision = last_revision + 1;
  guidance.path = request.path;
  guidance.given_by = client;
  guidance.belief_revision = belief.revision;
  guidance.answers_snapshot = request.answers_snapshot;
  guidance.valid_until = {now.nanoseconds + SimTime::FromSeconds(request.valid_for_s).nanoseconds};
  return guidance;
}

namespace {

template <class T>
T OrStartupError(const std::filesystem::path& file, Result<T>&& result) {
  if (result) return *std::move(result);
  const std::string& reason = result.error().text;  // names the file when SQLite gave it
  const bool named = reason.rfind(file.string(), 0) == 0;
  throw StartupError(fmt::format("operator database {}{}{}", named ? "" : file.string(),
                                 named ? "" : ": ", reason));
}

BeliefStore::Answer StorageFailure(const OperatorRequest& request, const Error& error,
                                   std::uint64_t revision) {
  std::string reason = fmt::format("not stored, ask again later: {}", error.text);
  return {Refusal(request, std::move(reason), revision), false, false, error.text};
}

/// In what the stored initial map differs from the new one; empty when it does not.
std::string Difference(const BeliefGrid& stored, const BeliefGrid& initial) {
  if (stored.rows() != initial.rows() || stored.columns() != initial.columns()) {
    return fmt::format("its initial map has {} x {} cells, the new one {} x {}", stored.rows(),
                       stored.columns(), initial.rows(), initial.columns());
  }
  int cells = 0;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored.values()[i] != initial.values()[i]) ++cells;
  }
  if (cells == 0) return "";
  return fmt::format("its initial map differs from the new one in {} cells", cells);
}

OperatorReply Accepted(const OperatorRequest& request, std::uint64_t revision) {
  return {request.client, request.request_id, true, "", revision};
}

}  // namespace

BeliefStore::BeliefStore(const BeliefStoreOptions& options)
    : database_(OrStartupError(options.database.file, Database::Open(options.database))),
      file_(options.database.file),
      limits_(options.limits) {
  OrStartupError(file_, EnsureSchema(database_).map([] { return true; }));
  beliefs_ = OrStartupError(file_, LoadBeliefs(database_));
  guidance_ = OrStartupError(file_, LoadGuidance(database_));
  stops_ = OrStartupError(file_, LoadStops(database_));
  goals_ = OrStartupError(file_, LoadGoals(database_));
  alerts_ = OrStartupError(file_, LoadAlerts(database_));
}

Result<bool> BeliefStore::AddWorld(const std::string& world, const BeliefGrid& initial,
                                   SimTime stamp) {
  const auto stored = InitialMap(world);
  if (!stored) return tl::unexpected(stored.error());
  if (*stored) {
    const std::string difference = Difference(**stored, initial);
    if (difference.empty()) return false;
    return Fail(ErrorCode::kRefused,
                fmt::format("operator database {} holds another world {}: {}; name another file in "
                            "operator.database or remove this one",
                            file_.string(), world, difference));
  }
  Belief belief{stamp, world, 0, initial, ""};
  auto saved = database_.Transaction([&] { return SaveBelief(database_, belief); });
  if (!saved) return tl::unexpected(saved.error());
  beliefs_[world] = std::move(belief);
  return true;
}

void BeliefStore::AddRobot(const std::string& robot, const std::string& world) {
  worlds_[robot] = world;
}

Result<void> BeliefStore::WithdrawGuidance(const std::string& robot, SimTime now) {
  const Guidance* last = FindGuidance(robot);
  if (last == nullptr) return {};
  Guidance withdrawn;
  withdrawn.stamp = now;
  withdrawn.valid_until = now;
  withdrawn.world = last->world;
  withdrawn.robot = robot;
  withdrawn.revision = last->revision + 1;
  auto saved = database_.Transaction([&] { return SaveGuidance(database_, withdrawn); });
  if (saved) guidance_[robot] = std::move(withdrawn);
  return saved;
}

std::optional<BeliefStore::Answer> BeliefStore::FindRepeat(const OperatorRequest& request) {
  const auto logged = FindRequest(database_, request.client, request.request_id);
  if (!logged) return StorageFailure(request, logged.error(), 0);
  if (!*logged) return std::nullopt;
  if ((*logged)->world == request.world && (*logged)->body == RequestBody(request)) {
    return Answer{(*logged)->reply};
  }
  return Answer{
      Refusal(request, fmt::format("request {} of client {} was used for something else before",
                                   request.request_id, request.client))};
}

BeliefStore::Answer BeliefStore::Keep(const OperatorRequest& request,
                                      const std::vector<StopOrder>& orders,
                                      const std::vector<Alert>& alerts,
                                      const std::vector<KeptGoals>& goals) {
  const OperatorReply reply = Accepted(request, 0);
  const auto saved = database_.Transaction([&]() -> Result<void> {
    for (const StopOrder& order : orders) {
      if (auto hold_saved = operators::SaveStop(database_, order); !hold_saved) return hold_saved;
    }
    for (const Alert& alert : alerts) {
      if (auto alert_saved = SaveAlert(database_, alert); !alert_saved) return alert_saved;
    }
    for (const KeptGoals& kept : goals) {
      if (auto goals_saved = operators::SaveGoals(database_, kept); !goals_saved)
        return goals_saved;
    }
    return SaveRequest(database_, request, reply);
  });
  if (!saved) return StorageFailure(request, saved.error(), 0);
  for (const StopOrder& order : orders) stops_[order.robot] = order;
  return {reply, true, true};
}

Result<void> BeliefStore::SaveStop(const StopOrder& order) {
  auto saved = database_.Transaction([&] { return operators::SaveStop(database_, order); });
  if (saved) stops_[order.robot] = order;
  return saved;
}

Result<void> BeliefStore::SaveGoals(const KeptGoals& kept) {
  return database_.Transaction([&] { return operators::SaveGoals(database_, kept); });
}

Result<void> BeliefStore::SaveAlerts(const std::vector<Alert>& alerts,
                                     const std::vector<std::uint64_t>& dropped) {
  return database_.Transaction([&]() -> Result<void> {
    for (const Alert& alert : alerts) {
      if (auto saved = SaveAlert(database_, alert); !saved) return saved;
    }
    for (const std::uint64_t id : dropped) {
      if (auto removed = RemoveAlert(database_, id); !removed) return removed;
    }
    return {};
  });
}

Result<std::int64_t> BeliefStore::CountRequests() { return operators::CountRequests(database_); }

Result<std::int64_t> BeliefStore::ForgetRequests(double wall_s, std::int64_t most) {
  return RemoveRequests(database_, wall_s, most);
}

BeliefStore::Answer BeliefStore::Handle(const OperatorRequest& request, SimTime now) {
  DEMAND(std::holds_alternative<EditRequest>(request.body) ||
             std::holds_alternative<GuideRequest>(request.body) ||
             std::holds_alternative<AnswerRequest>(request.body),
         request.client, request.request_id);
  if (auto repeat = FindRepeat(request)) return *std::move(repeat);
  return HandleNew(request, now);
}

BeliefStore::Answer BeliefStore::HandleNew(const OperatorRequest& request, SimTime now) {
  if (request.client.empty()) return Refuse(request, "the request names no client", 0);
  if (FindBelief(request.world) == nullptr) {
    return Refuse(request, fmt::format("world '{}' is unknown", request.world), 0);
  }
  if (const auto* edit = std::get_if<EditRequest>(&request.body)) {
    return HandleEdit(request, *edit, now);
  }
  if (const auto* answer = std::get_if<AnswerRequest>(&request.body)) {
    return HandleAnswer(request, *answer, now);
  }
  return HandleGuide(request, std::get<GuideRequest>(request.body), now);
}

BeliefStore::Answer BeliefStore::HandleEdit(const OperatorRequest& request, const EditRequest& edit,
                                            SimTime now) {
  Belief& current = beliefs_.at(request.world);
  auto edited = ApplyEdit(current, edit, request.client, now);
  if (!edited) return Refuse(request, edited.error().text, current.revision);
  const OperatorReply reply = Accepted(request, edited->revision);
  const auto saved = database_.Transaction([&]() -> Result<void> {
    if (auto belief_saved = SaveBelief(database_, *edited); !belief_saved) return belief_saved;
    return SaveRequest(database_, request, reply);
  });
  if (!saved) return StorageFailure(request, saved.error(), current.revision);
  current = *std::move(edited);
  return {reply, true, true};
}

BeliefStore::Answer BeliefStore::HandleGuide(const OperatorRequest& request,
                                             const GuideRequest& guide, SimTime now) {
  const Guidance* last = FindGuidance(guide.robot);
  const std::uint64_t last_revision = last != nullptr ? last->revision : 0;
  if (std::string why = WhyUnknown(request, guide.robot); !why.empty()) {
    return Refuse(request, std::move(why), last_revision);
  }
  auto guidance =
      MakeGuidance(beliefs_.at(request.world), guide, last_revision, request.client, now, limits_);
  if (!guidance) return Refuse(request, guidance.error().text, last_revision);
  // Of guidance robots see the newest only: what was answered before stays answered.
  if (last != nullptr) {
    guidance->answers_snapshot = std::max(guidance->answers_snapshot, last->answers_snapshot);
  }
  return SaveAsAnswer(request, *std::move(guidance));
}

BeliefStore::Answer BeliefStore::HandleAnswer(const OperatorRequest& request,
                                              const AnswerRequest& answer, SimTime now) {
  if (std::string why = WhyUnknown(request, answer.robot); !why.empty()) {
    return Refuse(request, std::move(why), 0);
  }
  Guidance guidance;
  if (const Guidance* last = FindGuidance(answer.robot)) guidance = *last;
  if (guidance.answers_snapshot >= answer.snapshot) {
    return Refuse(
        request, fmt::format("picture {} of {} was answered before", answer.snapshot, answer.robot),
        guidance.revision);
  }
  if (guidance.path.empty()) guidance.valid_until = now;
  guidance.world = request.world;
  guidance.robot = answer.robot;
  guidance.stamp = now;
  guidance.given_by = request.client;
  guidance.answers_snapshot = answer.snapshot;
  guidance.belief_revision = beliefs_.at(request.world).revision;
  ++guidance.revision;
  return SaveAsAnswer(request, std::move(guidance));
}

std::string BeliefStore::WhyUnknown(const OperatorRequest& request,
                                    const std::string& robot) const {
  const auto found = worlds_.find(robot);
  if (found != worlds_.end() && found->second == request.world) return "";
  return fmt::format("robot '{}' is not known in world {}", robot, request.world);
}

BeliefStore::Answer BeliefStore::SaveAsAnswer(const OperatorRequest& request, Guidance guidance) {
  const OperatorReply reply = Accepted(request, guidance.revision);
  const auto saved = database_.Transaction([&]() -> Result<void> {
    if (auto path_saved = SaveGuidance(database_, guidance); !path_saved) return path_saved;
    return SaveRequest(database_, request, reply);
  });
  if (!saved) return StorageFailure(request, saved.error(), guidance.revision - 1);
  guidance_[guidance.robot] = std::move(guidance);
  return {reply, true, true};
}

BeliefStore::Answer BeliefStore::Refuse(const OperatorRequest& request, std::string reason,
                                        std::uint64_t revision) {
  const OperatorReply reply = Refusal(request, std::move(reason), revision);
  // A refusal is as final as an acceptance. When it cannot be stored, a repeat is decided again,
  // which changes nothing that was acknowledged.
  const auto saved = database_.Transaction([&] { return SaveRequest(database_, request, reply); });
  return {reply, false, saved.has_value(), saved ? "" : saved.error().text};
}

void BeliefStore::Place(const std::string& world, const GridGeometry& grid) {
  const auto found = beliefs_.find(world);
  if (found == beliefs_.end()) return;
  found->second.cell_size_m = grid.cell_size_m;
  found->second.middle = grid.middle;
}

const Belief* BeliefStore::FindBelief(const std::string& world) const {
  const auto found = beliefs_.find(world);
  return found == beliefs_.end() ? nullptr : &found->second;
}

const Guidance* BeliefStore::FindGuidance(const std::string& robot) const {
  const auto found = guidance_.find(robot);
  return found == guidance_.end() ? nullptr : &found->second;
}

Result<std::optional<BeliefGrid>> BeliefStore::InitialMap(const std::string& world) {
  return LoadInitialMap(database_, world);
}

}  // namespace conav::operators
