#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "operator/belief/alert.h"
#include "operator/belief/database.h"

/// What a client may do to the belief and to guidance. Pure functions: the new value, or kRefused
/// with a reason that names the value and the limit and can be shown to a person as it is.
namespace conav::operators {

struct GuidanceLimits {
  double valid_for_s = 7200.0;  // simulation time
  int path_cells = 10000;
};

/// The belief after `request`: the edited cells at 0 or 1, revision + 1. Refused: no edits, a cell
/// outside of the map, on its border or named twice, a base revision that is not the current one
/// (the edits of somebody else came first; look again).
[[nodiscard]] Result<Belief> ApplyEdit(const Belief& current, const EditRequest& request,
                                       const std::string& client, SimTime now);

/// The guidance of `request` on `belief`; its revision is one above `last_revision`. An empty path
/// withdraws the guidance. Refused: cells outside of the map, steps that are not to a neighbour, a
/// path over the limit, valid_for_s not in (0, limit].
[[nodiscard]] Result<Guidance> MakeGuidance(const Belief& belief, const GuideRequest& request,
                                            std::uint64_t last_revision, const std::string& client,
                                            SimTime now, const GuidanceLimits& limits);

struct BeliefStoreOptions {
  Database::Options database;
  GuidanceLimits limits;
};

/// The operator's decisions: the belief map of each world, the
/// guidance of each robot, which robots are stopped, the alerts, and the requests that were
/// answered.
///
/// Whatever Handle() acknowledges is on disk before it returns, together with its reply: opening
/// the same file again gives back the same beliefs, guidance, revisions and replies, also after a
/// kill or a loss of power. A request that is repeated (same client and request_id) gets the reply
/// of the first time and changes nothing; the same id with another content is refused.
///
/// When the disk is full or fails, a request is refused with that reason and nothing changes; such
/// a refusal is not remembered, so that a repeat may succeed later.
/// Threads: not synchronised; one owner. Calls block on the disk.
class BeliefStore {
 public:
  /// Throws StartupError that names the file: not to be opened, in use, corrupt, not ours.
  explicit BeliefStore(const BeliefStoreOptions& options);

  struct Answer {
    OperatorReply reply;
    bool changed = false;  // what the request asks for is new, not a repeat, and takes effect
    bool written = false;  // the disk took something in
    std::string storage_failure;  // why it did not; empty = it did, or was not asked to
  };

  /// Gives `world` its initial map as revision 0. False when the store has one already, which then
  /// stays. Errors: kIo; kRefused when the stored world began with another map (names the file).
  [[nodiscard]] Result<bool> AddWorld(const std::string& world, const BeliefGrid& initial,
                                      SimTime stamp);

  /// Guidance is accepted for robots that were added, in their world. Not durable: robots report
  /// again after a restart.
  void AddRobot(const std::string& robot, const std::string& world);

  /// Withdraws the guidance of `robot`, which then answers no picture: for a robot that starts a
  /// new run. The revision rises. Errors: kIo.
  [[nodiscard]] Result<void> WithdrawGuidance(const std::string& robot, SimTime now);

  /// `now`: simulation time of the request's world. `request` edits, guides or answers (demanded).
  Answer Handle(const OperatorRequest& request, SimTime now);

  /// The reply that a request with this client and id got before; nothing when it is new.
  std::optional<Answer> FindRepeat(const OperatorRequest& request);
  /// Stores a request that was decided elsewhere and is new, with what it leads to.
  Answer Keep(const OperatorRequest& request, const std::vector<StopOrder>& orders,
              const std::vector<Alert>& alerts = {}, const std::vector<KeptGoals>& goals = {});
  /// Of a stop that took effect without it.
  [[nodiscard]] Result<void> SaveStop(const StopOrder& order);
  [[nodiscard]] Result<void> SaveGoals(const KeptGoals& kept);
  /// Also removes those with the ids of `dropped`.
  [[nodiscard]] Result<void> SaveAlerts(const std::vector<Alert>& alerts,
                                        const std::vector<std::uint64_t>& dropped = {});
  /// Forgets requests that were answered before `wall_s` (s since 1970), the oldest first and at
  /// most `most` of them: no client repeats them any longer. Returns how many. Errors: kIo.
  [[nodiscard]] Result<std::int64_t> ForgetRequests(double wall_s, std::int64_t most);
  /// Answered ones that are stored. Errors: kIo.
  [[nodiscard]] Result<std::int64_t> CountRequests();
  /// Those stored before the start.
  const std::vector<Alert>& alerts() const { return alerts_; }
  /// Those stored so far.
  const std::map<std::string, StopOrder>& stops() const { return stops_; }
  const std::map<std::string, KeptGoals>& goals() const { return goals_; }

  /// Where the cells of a world's belief lie, of which nothing is stored: a map says it again.
  void Place(const std::string& world, const GridGeometry& grid);

  /// Null when unknown. Valid until the next call that is not const.
  const Belief* FindBelief(const std::string& world) const;
  const Guidance* FindGuidance(const std::string& robot) const;

  const std::map<std::string, Belief>& beliefs() const { return beliefs_; }
  const std::map<std::string, Guidance>& guidance() const { return guidance_; }

  [[nodiscard]] Result<std::optional<BeliefGrid>> InitialMap(const std::string& world);

 private:
  Answer HandleNew(const OperatorRequest& request, SimTime now);
  Answer HandleEdit(const OperatorRequest& request, const EditRequest& edit, SimTime now);
  Answer HandleGuide(const OperatorRequest& request, const GuideRequest& guide, SimTime now);
  /// "Nothing new here": the path stays, and answers the picture.
  Answer HandleAnswer(const OperatorRequest& request, const AnswerRequest& answer, SimTime now);
  /// Why `robot` is not guided in the world of `request`; empty = it is.
  std::string WhyUnknown(const OperatorRequest& request, const std::string& robot) const;
  Answer SaveAsAnswer(const OperatorRequest& request, Guidance guidance);
  Answer Refuse(const OperatorRequest& request, std::string reason, std::uint64_t revision);

  Database database_;
  std::filesystem::path file_;
  GuidanceLimits limits_;
  std::map<std::string, Belief> beliefs_;      // by world
  std::map<std::string, Guidance> guidance_;   // by robot
  std::map<std::string, StopOrder> stops_;     // by robot
  std::map<std::string, KeptGoals> goals_;     // by robot, at the start
  std::vector<Alert> alerts_;                  // at the start
  std::map<std::string, std::string> worlds_;  // of each robot
};

}  // namespace conav::operators
