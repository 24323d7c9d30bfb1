#include "operator/console/console_state.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "common/msg/method.h"
#include "operator/console/console_messages.h"

namespace conav::operators {
namespace {

constexpr double kTimePeriod = 0.2;    // s between updates of a world's time
constexpr double kHealthPeriod = 1.0;  // s, of a process that says the same

/// Cells that were entered after the trail's last one. The state's path leads there, unless states
/// between were not received: then with a gap. `moves`: cells entered since, 0 where it is not
/// counted.
std::vector<Cell> NewCells(const std::vector<Cell>& trail, const RobotState& state,
                           std::uint64_t moves) {
  const std::vector<Cell>& path = state.path;
  std::vector<Cell> fresh = path;
  if (!trail.empty()) {
    if (moves == 0 && trail.back() == state.cell) return {};
    const auto known = std::find(path.rbegin(), path.rend(), trail.back());
    if (moves > 0 && moves < path.size()) {
      fresh.assign(path.end() - static_cast<std::ptrdiff_t>(moves), path.end());
    } else if (known != path.rend()) {
      fresh.assign(known.base(), path.end());
    }
  }
  const Cell last = !fresh.empty() ? fresh.back() : !trail.empty() ? trail.back() : Cell{-1, -1};
  if (last != state.cell) fresh.push_back(state.cell);
  return fresh;
}

/// Whether `period_s` has passed, or the wall clock was set back.
bool IsDue(double sent_at_s, double now_s, double period_s) {
  return std::abs(now_s - sent_at_s) >= period_s;
}

/// Of "robot/r1", "trail/r1/3", ...: kind and robot; what a robot reported of its run, and the
/// operator did not make.
bool IsFromRobots(std::string_view key, const std::set<std::string, std::less<>>& robots) {
  constexpr std::array<std::string_view, 8> kKinds{"robot",  "seen",       "trail",   "plan",
                                                   "search", "prediction", "picture", "goal_pose"};
  const auto slash = key.find('/');
  if (slash == std::string_view::npos) return false;
  const std::string_view rest = key.substr(slash + 1);
  return std::find(kKinds.begin(), kKinds.end(), key.substr(0, slash)) != kKinds.end() &&
         robots.contains(rest.substr(0, rest.find('/')));
}

}  // namespace

ConsoleState::ConsoleState(UpdateLog& log, console::Session session)
    : log_(log), session_(std::move(session)) {
  PutSession();
}

void ConsoleState::PutSession() {
  console::Update update;
  *update.mutable_session() = session_;
  log_.Put("session", std::move(update));
}

void ConsoleState::Reset() {
  robots_.clear();
  worlds_.clear();
  services_.clear();
  service_sent_at_s_.clear();
  last_event_ = 0;
  log_.Clear();
  PutSession();
}

void ConsoleState::StartNewRun(std::string world) {
  std::set<std::string, std::less<>> gone;
  for (const auto& [robot, memory] : robots_) {
    if (memory.world == world) gone.insert(robot);
  }
  std::erase_if(robots_, [&](const auto& known) { return gone.contains(known.first); });
  worlds_[world].stamp = SimTime{};
  worlds_[world].sent_at_s = 0.0;
  log_.Forget([&](std::string_view key) { return IsFromRobots(key, gone); });
}

SimTime ConsoleState::TimeOf(const std::string& world) const {
  const auto found = worlds_.find(world);
  return found == worlds_.end() ? SimTime{} : found->second.stamp;
}

void ConsoleState::Receive(const RobotState& state, double received_s) {
  if (const auto known = robots_.find(state.robot);
      known != robots_.end() && state.stamp < known->second.stamp) {
    StartNewRun(known->second.world);
  }
  RobotMemory& memory = robots_[state.robot];
  memory.world = state.world;
  memory.stamp = state.stamp;
  if (state.snapshots < memory.answered) memory.answered = 0;  // a new run
  ExtendTrail(memory, state);
  console::Update update;
  *update.mutable_robot() = ToConsole(state, received_s);
  log_.Put("robot/" + state.robot, std::move(update));
  NoteTime(state, received_s);
}

void ConsoleState::ExtendTrail(RobotMemory& memory, const RobotState& state) {
  const std::uint64_t moves = std::max(state.cell_moves, memory.cell_moves) - memory.cell_moves;
  memory.cell_moves = state.cell_moves;
  const std::vector<Cell> fresh = NewCells(memory.trail, state, moves);
  for (auto cell = fresh.begin(); cell != fresh.end();) {
    if (memory.trail.size() == kTrailPiece) {
      memory.trail_before += kTrailPiece;
      memory.trail.clear();
    }
    const auto room = static_cast<std::ptrdiff_t>(kTrailPiece - memory.trail.size());
    const auto end = cell + std::min(room, fresh.end() - cell);
    memory.trail.insert(memory.trail.end(), cell, end);
    cell = end;
    PutTrail(state.robot, memory.trail_before, memory.trail);
  }
}

void ConsoleState::PutTrail(const std::string& robot, std::size_t first,
                            std::span<const Cell> cells) {
  console::Update update;
  update.mutable_trail()->set_robot(robot);
  update.mutable_trail()->set_first(static_cast<std::uint32_t>(first));
  AddCells(cells, update.mutable_trail()->mutable_cells());
  log_.Put(fmt::format("trail/{}/{}", robot, first / kTrailPiece), std::move(update),
           "trail/" + robot, kTrailPiecesKept);
}

void ConsoleState::NoteTime(const RobotState& state, double received_s) {
  WorldMemory& memory = worlds_[state.world];
  memory.stamp = std::max(memory.stamp, state.stamp);
  if (memory.world.rows() == 0 || !IsDue(memory.sent_at_s, received_s, kTimePeriod)) return;
  memory.sent_at_s = received_s;
  memory.world.set_time(memory.stamp.ToSeconds());
  console::Update update;
  *update.mutable_world() = memory.world;
  log_.Put("world/" + state.world, std::move(update));
}

void ConsoleState::ReceiveGeometry(const std::string& world, const MapUpdate& map) {
  WorldMemory& memory = worlds_[world];
  memory.world.set_name(world);
  memory.world.set_rows(map.cells.rows());
  memory.world.set_columns(map.cells.columns());
  memory.world.set_cell_size(map.cell_size_m);
  memory.world.set_middle_x(map.middle.x_m);
  memory.world.set_middle_y(map.middle.y_m);
  memory.world.set_time(memory.stamp.ToSeconds());
  console::Update update;
  *update.mutable_world() = memory.world;
  log_.Put("world/" + world, std::move(update));
}

void ConsoleState::ReceiveSeen(const std::string& robot, const std::string& world,
                               const MapUpdate& map) {
  std::string cells = Packed(map.cells);
  RobotMemory& memory = robots_[robot];
  if (cells == memory.seen) return;
  memory.seen = cells;
  console::Update update;
  update.mutable_seen()->set_robot(robot);
  update.mutable_seen()->set_world(world);
  update.mutable_seen()->set_stamp(map.stamp.ToSeconds());
  update.mutable_seen()->set_cells(std::move(cells));
  log_.Put("seen/" + robot, std::move(update));
}

void ConsoleState::ReceiveTruth(const std::string& world, const OccupancyGrid& truth) {
  console::Update update;
  update.mutable_truth()->set_world(world);
  update.mutable_truth()->set_cells(Packed(truth));
  log_.Put("truth/" + world, std::move(update));
}

void ConsoleState::Receive(const Belief& belief, const BeliefGrid& initial) {
  console::Update update;
  console::Belief* message = update.mutable_belief();
  message->set_world(belief.world);
  message->set_revision(belief.revision);
  message->set_walls(Packed(belief.wall_probability));
  message->set_edited_by(belief.edited_by);
  message->set_stamp(belief.stamp.ToSeconds());
  message->set_initial_walls(Packed(initial));
  log_.Put("belief/" + belief.world, std::move(update));
}

void ConsoleState::Receive(const Guidance& guidance) {
  console::Update update;
  *update.mutable_guidance() = ToConsole(guidance);
  log_.Put("guidance/" + guidance.robot, std::move(update));
  Answered(guidance.robot, guidance.answers_snapshot, console::ANSWER_PATH, guidance.given_by);
}

void ConsoleState::ReceivePlan(const std::string& robot, SimTime stamp,
                               const std::vector<Cell>& cells) {
  console::Update update;
  update.mutable_plan()->set_robot(robot);
  update.mutable_plan()->set_stamp(stamp.ToSeconds());
  AddCells(cells, update.mutable_plan()->mutable_cells());
  log_.Put("plan/" + robot, std::move(update));
}

void ConsoleState::Receive(const SearchReport& report) {
  if (session_.method() != report.method) {
    SetMethod(report.method, session_);
    PutSession();
  }
  console::Update update;
  *update.mutable_search() = ToConsole(report);
  log_.Put("search/" + report.robot, std::move(update));
}

void ConsoleState::Receive(console::Snapshot snapshot) {
  RobotMemory& memory = robots_[snapshot.robot()];
  // A simulator that was killed shows its newest picture again.
  if (memory.unanswered && memory.unanswered->sequence_number() != snapshot.sequence_number()) {
    memory.unanswered->set_answer(console::ANSWER_OUTDATED);
    PutSnapshot(*std::exchange(memory.unanswered, std::nullopt));
  }
  Close(snapshot, memory);
  if (snapshot.answer() == console::ANSWER_NONE) memory.unanswered = snapshot;
  PutSnapshot(snapshot);
}

void ConsoleState::ReceiveSnapshotAgain(const std::string& robot, double now_s) {
  RobotMemory& memory = robots_[robot];
  if (!memory.newest_snapshot) return;
  if (memory.unanswered) memory.unanswered->set_received_at(now_s);
  memory.newest_snapshot->set_received_at(now_s);
  PutSnapshot(console::Snapshot(*memory.newest_snapshot));
}

void ConsoleState::PutSnapshot(const console::Snapshot& snapshot) {
  std::optional<console::Snapshot>& newest = robots_[snapshot.robot()].newest_snapshot;
  if (!newest || newest->sequence_number() <= snapshot.sequence_number()) newest = snapshot;
  console::Update update;
  *update.mutable_snapshot() = snapshot;
  log_.Put(fmt::format("picture/{}/{}", snapshot.robot(), snapshot.sequence_number()),
           std::move(update), "picture/" + snapshot.robot(), kSnapshotsKept);
}

void ConsoleState::Close(console::Snapshot& snapshot, const RobotMemory& memory) {
  if (snapshot.sequence_number() > memory.answered) return;
  const bool is_the_one = snapshot.sequence_number() == memory.answered;
  snapshot.set_answer(is_the_one ? memory.answer : console::ANSWER_OUTDATED);
  if (is_the_one) snapshot.set_answered_by(memory.answered_by);
}

void ConsoleState::Answered(const std::string& robot, std::uint64_t snapshot,
                            console::SnapshotAnswer answer, const std::string& by) {
  RobotMemory& memory = robots_[robot];
  if (snapshot <= memory.answered) return;
  memory.answered = snapshot;
  memory.answer = answer;
  memory.answered_by = by;
  if (!memory.unanswered || memory.unanswered->sequence_number() > snapshot) return;
  Close(*memory.unanswered, memory);
  PutSnapshot(*std::exchange(memory.unanswered, std::nullopt));
}

void ConsoleState::ReceiveAnswer(const std::string& robot, std::uint64_t snapshot,
                                 const std::string& client) {
  Answered(robot, snapshot, console::ANSWER_NOTHING_NEW, client);
}

void ConsoleState::Receive(const std::string& robot, const std::string& world,
                           std::uint64_t snapshot, const std::string& model,
                           const PerceptionAnswer& answer) {
  console::Update update;
  console::Prediction* message = update.mutable_prediction();
  message->set_robot(robot);
  message->set_world(world);
  message->set_snapshot(snapshot);
  message->set_add(Packed(answer.add));
  message->set_remove(Packed(answer.remove));
  message->set_model(model);
  log_.Put("prediction/" + robot, std::move(update));
}

void ConsoleState::Receive(const AttentionQueueState& queue) {
  console::Update update;
  *update.mutable_attention() = ToConsole(queue);
  log_.Put("attention", std::move(update));
}

void ConsoleState::ReceiveGoalPose(const std::string& robot, Cell cell, double stamp_s) {
  console::Update update;
  update.mutable_goal_pose()->set_robot(robot);
  *update.mutable_goal_pose()->mutable_cell() = ToConsole(cell);
  update.mutable_goal_pose()->set_stamp(stamp_s);
  log_.Put("goal_pose/" + robot, std::move(update));
}

void ConsoleState::Receive(const ServiceHealth& health, double now_s) {
  const auto known = services_.find(health.name);
  double& sent_at_s = service_sent_at_s_[health.name];
  if (known != services_.end() && known->second == health &&
      !IsDue(sent_at_s, now_s, kHealthPeriod)) {
    return;
  }
  services_[health.name] = health;
  sent_at_s = now_s;
  console::Update update;
  update.mutable_service()->set_name(health.name);
  update.mutable_service()->set_level(health.level);
  update.mutable_service()->set_message(health.message);
  update.mutable_service()->set_received_at(now_s);
  log_.Put("service/" + health.name, std::move(update));
}

void ConsoleState::Receive(const std::vector<Person>& people) {
  console::Update update;
  update.mutable_presence();
  for (const Person& person : people) {
    console::Person* to = update.mutable_presence()->add_people();
    to->set_client(person.client);
    to->set_name(person.name);
    to->set_role(person.role);
  }
  log_.Put("presence", std::move(update));
}

void ConsoleState::Receive(console::Event event) {
  event.set_id(++last_event_);
  console::Update update;
  *update.mutable_event() = std::move(event);
  log_.Put(fmt::format("event/{}", last_event_), std::move(update), "event", kEventsKept);
}

void ConsoleState::Receive(console::Control control) {
  const std::string key = "control/" + control.robot();
  console::Update update;
  *update.mutable_control() = std::move(control);
  log_.Put(key, std::move(update));
}

void ConsoleState::Receive(const console::Alert& alert) {
  console::Update update;
  *update.mutable_alert() = alert;
  const std::string key = fmt::format("alert/{}", alert.id());
  if (alert.active() || alert.acknowledged_by().empty()) {
    log_.Put(key, std::move(update));
  } else {
    log_.Put(key, std::move(update), "alert", kAlertsKept);
  }
}

void ConsoleState::ReceiveStep(console::Update update) {
  const std::string key = fmt::format("task/{}", static_cast<int>(update.body_case()));
  log_.Put(key, std::move(update));
}

void ConsoleState::Receive(const console::Playback& playback) {
  console::Update update;
  *update.mutable_playback() = playback;
  log_.Put("playback", std::move(update));
}

}  // namespace conav::operators
