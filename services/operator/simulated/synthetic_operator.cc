#include "operator/simulated/synthetic_operator.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace conav::operators {
namespace {

/// Of the pause before what was refused is asked again.
constexpr int kMostDoublings = 5;

/// The operator service takes paths of so many cells (GuidanceLimits); the rest is drawn later.
constexpr std::size_t kLongestPath = 10000;

/// FNV-1a: the same number for a name on every platform.
std::uint64_t HashOf(const std::string& name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char character : name) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001b3ULL;
  }
  return hash;
}

/// Standard normal (Box and Muller 1958).
double NormalDraw(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.Unit()));
  return radius * std::cos(2.0 * std::numbers::pi * random.Unit());
}

double MeanOf(AttentionReason reason, const InteractionTimeParameters& times) {
  switch (reason) {
    case AttentionReason::kSnapshot:
      return times.picture_s;
    case AttentionReason::kBlocked:
      return times.blocked_s;
    default:
      return times.path_s;
  }
}

}  // namespace

int WingInference::Contradictions(const BeliefGrid& map, const Wing& wing) const {
  int count = 0;
  for (const auto& [cell, wall] : seen_) {
    if (wing.Contains(cell, map.rows(), map.columns()) && IsWall(map, cell) != wall) ++count;
  }
  return count;
}

std::vector<CellEdit> WingInference::See(const VisibleCells& visible, const BeliefGrid& belief) {
  for (const Cell cell : visible.free) seen_[cell] = false;
  for (const Cell cell : visible.walls) seen_[cell] = true;
  for (int side = 0; side < 4 && !believes_; ++side) {
    for (const Wing& error : {Wing{side, WingError::kMirrored}, Wing{side, WingError::kShifted, 2},
                              Wing{side, WingError::kShifted, -2}}) {
      const int now = Contradictions(first_, error);
      if (now < kEvidence) continue;
      const BeliefGrid mended = WithError(first_, error.Inverse());
      if (4 * Contradictions(mended, error) > now) continue;
      believes_ = true;
      std::vector<CellEdit> edits;
      for (std::size_t i = 0; i < mended.size(); ++i) {
        const Cell cell = mended.CellAt(i);
        if (!error.Contains(cell, mended.rows(), mended.columns())) continue;
        const auto seen = seen_.find(cell);
        const bool wall = seen != seen_.end() ? seen->second : IsWall(mended, cell);
        if (wall != IsWall(belief, cell)) edits.push_back({cell, wall});
      }
      return edits;
    }
  }
  return {};
}

SyntheticOperator::SyntheticOperator(const SyntheticOperatorParameters& parameters,
                                     std::uint64_t seed,
                                     const std::map<std::string, std::string>& world_of_robot)
    : parameters_(parameters) {
  for (const auto& [name, world] : world_of_robot) {
    SnapshotReader reader(parameters.reader, DeriveSeed(seed, HashOf(name)));
    const Random interaction_times(DeriveSeed(seed, ~HashOf(name)));
    const Random noticing(DeriveSeed(seed, HashOf(name + "/goals")));
    robots_.emplace(name,
                    Robot{world, std::move(reader), interaction_times, noticing, {}, 0, 0, {}, {}});
    worlds_[world];
  }
}

SyntheticOperator::Robot* SyntheticOperator::Find(const std::string& robot,
                                                  const std::string& world) {
  const auto found = robots_.find(robot);
  return found != robots_.end() && found->second.world == world ? &found->second : nullptr;
}

void SyntheticOperator::Receive(const Belief& belief) {
  const auto world = worlds_.find(belief.world);
  if (world == worlds_.end()) return;
  // A service that lost its database starts over at 0; then its map is the one that counts.
  if (belief.revision == 0) world->second.revision_needed = 0;
  world->second.belief = belief;
  if (!world->second.wings) world->second.wings.emplace(belief.wall_probability);
}

void SyntheticOperator::Receive(const RobotState& state) {
  Robot* robot = Find(state.robot, state.world);
  if (robot == nullptr) return;
  const bool restarted = robot->state && state.stamp < robot->state->stamp;
  if (restarted) {
    robot->received = robot->looked_at = robot->answered = 0;
    robot->marked.clear();
  }
  if (restarted || !robot->state) {
    queue_.push_back({.robot = state.robot, .occasion = FirstPath{}});
  }
  worlds_[state.world].certain_walls.erase(state.cell);
  robot->state = state;
}

void SyntheticOperator::Receive(const Snapshot& snapshot, Clock::TimePoint now) {
  Robot* robot = Find(snapshot.robot, snapshot.world);
  if (robot == nullptr || snapshot.sequence_number <= robot->received) return;
  robot->received = snapshot.sequence_number;
  if (snapshot.sequence_number <= robot->answered) {
    robot->looked_at = std::max(robot->looked_at, snapshot.sequence_number);
    return;
  }
  if (FollowsQueue() && snapshot.streamed) {
    robot->looked_at = std::max(robot->looked_at, snapshot.sequence_number);
    robot->streamed = snapshot;
    return;
  }
  Snapshot kept = snapshot;
  kept.jpeg = {};  // it reads what the picture shows
  queue_.push_back({.robot = snapshot.robot, .occasion = std::move(kept), .received_at = now});
  if (queue_.size() <= kMostWaiting) return;
  const auto oldest = std::ranges::find_if(
      queue_, [](const Item& item) { return std::holds_alternative<Snapshot>(item.occasion); });
  std::uint64_t& looked_at = robots_.at(oldest->robot).looked_at;
  looked_at = std::max(looked_at, std::get<Snapshot>(oldest->occasion).sequence_number);
  queue_.erase(oldest);
  ++counts_.given_up;
}

void SyntheticOperator::Receive(const AttentionRequest& attention, Clock::TimePoint now) {
  Robot* robot = Find(attention.robot, attention.world);
  if (robot == nullptr || attention.reason == AttentionReason::kSnapshot) return;
  if (robot->attention == attention) return;  // repeated
  robot->attention = attention;
  std::erase_if(queue_, [&](const Item& item) {  // what it asked before is out of date
    return item.robot == attention.robot && std::holds_alternative<AttentionRequest>(item.occasion);
  });
  if (attention.reason == AttentionReason::kNone) return;  // withdrawn
  queue_.push_back({.robot = attention.robot, .occasion = attention, .received_at = now});
}

void SyntheticOperator::Receive(const Guidance& guidance) {
  Robot* robot = Find(guidance.robot, guidance.world);
  if (robot != nullptr) robot->answered = guidance.answers_snapshot;
}

void SyntheticOperator::ReceiveGoalObjects(const std::string& robot,
                                           std::vector<Position> objects) {
  const auto found = robots_.find(robot);
  if (found != robots_.end()) found->second.goal_objects = std::move(objects);
}

void SyntheticOperator::Receive(const AttentionQueueState& queue) {
  // A service that restarts begins its count again.
  if (published_ && queue.revision < published_->revision) refused_at_ = 0;
  published_ = queue;
}

bool SyntheticOperator::Ready(const Item& item, Clock::TimePoint now) const {
  const Robot& robot = robots_.at(item.robot);
  if (!worlds_.at(robot.world).belief) return false;
  const auto* attention = std::get_if<AttentionRequest>(&item.occasion);
  if (attention == nullptr || ReadyForAttention(robot, *attention)) return true;
  return robot.state && now >= item.received_at + Seconds(parameters_.patience_s);
}

bool SyntheticOperator::ReadyForAttention(const Robot& robot,
                                          const AttentionRequest& attention) const {
  return robot.state && robot.state->stamp >= attention.stamp &&
         robot.looked_at >= attention.newest_snapshot;
}

std::deque<SyntheticOperator::Item>::iterator SyntheticOperator::FirstOfQueue(
    Clock::TimePoint now) {
  if (!published_ || published_->revision <= refused_at_) return queue_.end();
  for (const AttentionItem& asked : published_->items) {
    if (!asked.selected_by.empty()) continue;
    const auto item = std::find_if(queue_.begin(), queue_.end(), [&](const Item& candidate) {
      if (candidate.robot != asked.robot || !Ready(candidate, now)) return false;
      if (const auto* attention = std::get_if<AttentionRequest>(&candidate.occasion)) {
        return attention->reason == asked.reason;
      }
      const auto* snapshot = std::get_if<Snapshot>(&candidate.occasion);
      return snapshot != nullptr ? asked.reason == AttentionReason::kSnapshot &&
                                       snapshot->sequence_number == asked.newest_snapshot
                                 : asked.reason == AttentionReason::kFirstPath;
    });
    if (item == queue_.end()) continue;
    item->reason = asked.reason;
    return item;
  }
  return queue_.end();
}

SimTime SyntheticOperator::BusyUntil(const Item& item) {
  const InteractionTimeParameters& times = parameters_.interaction;
  const double draw = NormalDraw(robots_.at(item.robot).interaction_times);
  const double spread = std::exp(times.log_sd * (draw - times.log_sd / 2.0));  // of mean 1
  return operator_time_ + Seconds(MeanOf(item.reason, times) * spread);
}

bool SyntheticOperator::TakeUp(Clock::TimePoint now) {
  const auto next = FollowsQueue()
                        ? FirstOfQueue(now)
                        : std::find_if(queue_.begin(), queue_.end(),
                                       [&](const Item& item) { return Ready(item, now); });
  if (next == queue_.end()) return false;
  current_ = std::move(*next);
  queue_.erase(next);
  current_->not_before = now + Seconds(parameters_.thinking_time_s);
  return true;
}

void SyntheticOperator::Selected(const Result<OperatorReply>& reply, Clock::TimePoint now) {
  if (reply && reply->accepted) {
    current_->selected = true;
    current_->busy_until = BusyUntil(*current_);
    current_->not_before = now + Seconds(parameters_.thinking_time_s);
    return;
  }
  // It was answered or withdrawn meanwhile, or nobody replied: look again at the newer queue.
  refused_at_ = published_->revision;
  queue_.push_front(*std::exchange(current_, std::nullopt));
}

std::optional<OperatorAsk> SyntheticOperator::Next(Clock::TimePoint now) {
  if (parameters_.silent) queue_.clear();
  while (!under_way_ && (current_ || TakeUp(now))) {
    if (FollowsQueue() && !current_->selected) {
      under_way_ = OperatorAsk{robots_.at(current_->robot).world, operator_time_,
                               SelectRequest{current_->robot, current_->reason}};
      break;
    }
    if (now < current_->not_before || operator_time_ < current_->busy_until) return std::nullopt;
    const World& world = worlds_.at(robots_.at(current_->robot).world);
    if (world.belief->revision < world.revision_needed) return std::nullopt;
    if (!std::exchange(current_->looked, true)) {
      current_->marks = MarksFor(*current_);
      current_->edits = EditsFor(*current_);
    }
    under_way_ = MarkAsk(*current_);
    if (!under_way_) under_way_ = EditAsk(*current_);
    if (!under_way_) under_way_ = GuideAsk(*current_);
    if (!under_way_) Finish();
  }
  return under_way_ && !std::exchange(asked_, true) ? under_way_ : std::nullopt;
}

void SyntheticOperator::Answered(const Result<OperatorReply>& reply, Clock::TimePoint now) {
  DEMAND(under_way_ && current_);
  const bool edit = std::holds_alternative<EditRequest>(under_way_->body);
  const bool mark = std::holds_alternative<GoalsRequest>(under_way_->body);
  const bool select = std::holds_alternative<SelectRequest>(under_way_->body);
  under_way_.reset();
  asked_ = false;
  if (select) return Selected(reply, now);
  Robot& robot = robots_.at(current_->robot);
  World& world = worlds_.at(robot.world);
  if (reply && edit) world.revision_needed = std::max(world.revision_needed, reply->revision);
  if (reply && reply->accepted) {
    if (mark) {
      robot.marked.insert(current_->marks.begin(), current_->marks.end());
      return current_->marks.clear();
    }
    if (!edit) {
      ++counts_.guidance;
      return Finish();
    }
    counts_.edits += current_->edits.size();
    current_->edits.clear();
    return;
  }
  ++counts_.refused;
  counts_.newest_problem = reply ? reply->reason : reply.error().text;
  // The longer it is refused, the less it asks: another client may keep control of the robot.
  const double pauses = std::exp2(std::min(current_->attempts, kMostDoublings));
  current_->not_before = now + Seconds(pauses * parameters_.retry_pause_s);
  if (++current_->attempts < parameters_.attempts) return;
  current_->attempts = 0;
  ++counts_.given_up;
  if (!mark && !edit) return Finish();
  (mark ? current_->marks.clear() : current_->edits.clear());  // the guidance is still owed
}

void SyntheticOperator::Finish() {
  if (const auto* snapshot = std::get_if<Snapshot>(&current_->occasion)) {
    Robot& robot = robots_.at(current_->robot);
    robot.looked_at = std::max(robot.looked_at, snapshot->sequence_number);
    std::erase_if(queue_,
                  [&](const Item& item) {  // pictures that it went on without answers to
                    const auto* older = std::get_if<Snapshot>(&item.occasion);
                    return FollowsQueue() && item.robot == current_->robot && older != nullptr &&
                           older->sequence_number < snapshot->sequence_number;
                  });
  }
  current_.reset();
}

std::vector<CellEdit> SyntheticOperator::EditsFor(const Item& item) {
  Robot& robot = robots_.at(item.robot);
  World& world = worlds_.at(robot.world);
  if (const auto* snapshot = std::get_if<Snapshot>(&item.occasion)) {
    ++counts_.snapshots;
    if (snapshot->streamed && !robot.reader.Glances(parameters_.glance_rate)) return {};
    if (parameters_.infers_wings) {
      std::vector<CellEdit> edits =
          world.wings->See(snapshot->visible, world.belief->wall_probability);
      if (!edits.empty()) return edits;
    }
    return robot.reader.Read(world.belief->wall_probability, *snapshot, world.certain_walls);
  }
  if (const auto* attention = std::get_if<AttentionRequest>(&item.occasion)) {
    std::vector<CellEdit> edits = MarkBlocked(*attention, robot, world);
    LookAtStream(robot, world, edits);
    return edits;
  }
  return {};
}

void SyntheticOperator::LookAtStream(Robot& robot, const World& world,
                                     std::vector<CellEdit>& edits) {
  if (!robot.streamed) return;
  ++counts_.snapshots;
  const auto seen =
      robot.reader.Read(world.belief->wall_probability, *robot.streamed, world.certain_walls);
  const std::size_t marked = edits.size();  // one cell at most
  for (const CellEdit& edit : seen) {
    const auto taken = std::span(edits).first(marked);
    if (std::ranges::find(taken, edit.cell, &CellEdit::cell) == taken.end()) edits.push_back(edit);
  }
  robot.streamed.reset();
}

std::vector<CellEdit> SyntheticOperator::MarkBlocked(const AttentionRequest& attention,
                                                     const Robot& robot, World& world) {
  const BeliefGrid& map = world.belief->wall_probability;
  const bool another_robot = robot.state->command_outcome == CommandOutcome::kOccupied &&
                             robot.state->command_cell == attention.cell;
  if (attention.reason != AttentionReason::kBlocked || another_robot ||
      !map.Contains(attention.cell) || map.OnBorder(attention.cell)) {
    return {};
  }
  world.certain_walls.insert(attention.cell);
  return {{attention.cell, true}};
}

std::vector<Cell> SyntheticOperator::MarksFor(const Item& item) {
  const auto* snapshot = std::get_if<Snapshot>(&item.occasion);
  if (snapshot == nullptr || snapshot->streamed || !parameters_.marks_goals) return {};
  Robot& robot = robots_.at(item.robot);
  std::vector<Cell> goals;
  for (const Position object : robot.goal_objects) {
    const Cell cell = snapshot->grid.PositionToCell(object);
    const bool is_given = robot.marked.contains(cell) ||
                          (robot.state && (Contains(robot.state->goals_left, cell) ||
                                           Contains(robot.state->goals_reached, cell)));
    if (!is_given) goals.push_back(cell);
  }
  return NoticedGoals(parameters_.reader, *snapshot, goals, robot.noticing);
}

std::optional<OperatorAsk> SyntheticOperator::MarkAsk(const Item& item) const {
  if (item.marks.empty()) return std::nullopt;
  const auto& snapshot = std::get<Snapshot>(item.occasion);
  GoalsRequest request{item.robot, {}, {}};
  for (const Cell goal : item.marks) request.add.push_back(snapshot.grid.CellToPosition(goal));
  return OperatorAsk{robots_.at(item.robot).world, snapshot.stamp, request};
}

std::optional<OperatorAsk> SyntheticOperator::EditAsk(const Item& item) const {
  const Robot& robot = robots_.at(item.robot);
  const Belief& belief = *worlds_.at(robot.world).belief;
  EditRequest request{belief.revision, item.edits};
  std::erase_if(request.edits, [&](const CellEdit& edit) {
    return IsWall(belief.wall_probability, edit.cell) == edit.wall;
  });
  if (request.edits.empty()) return std::nullopt;
  return OperatorAsk{robot.world, robot.state ? robot.state->stamp : SimTime{}, request};
}

std::optional<OperatorAsk> SyntheticOperator::GuideAsk(const Item& item) {
  const Robot& robot = robots_.at(item.robot);
  const World& world = worlds_.at(robot.world);
  const auto* snapshot = std::get_if<Snapshot>(&item.occasion);
  if (snapshot != nullptr && snapshot->streamed) return std::nullopt;
  // The picture says where the robot is, unless a newer state is here already.
  const bool from_snapshot =
      snapshot != nullptr && (!robot.state || robot.state->stamp < snapshot->stamp);
  const Cell start = from_snapshot ? snapshot->cell : robot.state->cell;
  std::vector<Cell> goals = from_snapshot ? snapshot->goals_left : robot.state->goals_left;
  for (const Cell goal : robot.marked) {  // also before the robot's state has them
    const bool is_reached = robot.state && Contains(robot.state->goals_reached, goal);
    if (!is_reached && !Contains(goals, goal)) goals.push_back(goal);
  }

  GuideRequest request{item.robot, {}, 0, parameters_.guidance_valid_s};
  if (snapshot != nullptr) request.answers_snapshot = snapshot->sequence_number;
  if (std::holds_alternative<AttentionRequest>(item.occasion)) {
    request.answers_snapshot = robot.looked_at;
  }
  const GridGeometry& grid = from_snapshot ? snapshot->grid : robot.state->grid;
  auto path = PathPlanner(parameters_.planner, grid.cell_size_m)
                  .Plan(world.belief->wall_probability, world.certain_walls, start, goals);
  if (path) {
    request.path = *std::move(path);
    if (request.path.size() > kLongestPath) request.path.resize(kLongestPath);
  } else {
    counts_.newest_problem = path.error().text;  // answered nevertheless, without a path
  }
  return OperatorAsk{robot.world, robot.state ? robot.state->stamp : snapshot->stamp, request};
}

void InteractionTimeParameters::Visit(ConfigReader& reader) {
  reader.Field("picture_s", picture_s, 0.0, 3600.0);
  reader.Field("blocked_s", blocked_s, 0.0, 3600.0);
  reader.Field("path_s", path_s, 0.0, 3600.0);
  reader.Field("log_sd", log_sd, 0.0, 5.0);
}

void SyntheticOperatorParameters::Visit(ConfigReader& visitor) {
  if (visitor.reading()) {
    std::string kind = "careful";
    visitor.Choice("kind", kind, OperatorKinds());
    *this = ParametersOfKind(kind);
  }
  visitor.Field("silent", silent);
  visitor.Field("infers_wings", infers_wings);
  visitor.Field("marks_goals", marks_goals);
  visitor.Section("reader", reader);
  visitor.Section("planner", planner);
  visitor.Section("steering", steering);
  visitor.Field("glance_rate", glance_rate, 0.0, 1.0);
  visitor.Field("thinking_time_s", thinking_time_s, 0.0, 3600.0);
  visitor.Field("guidance_valid_s", guidance_valid_s, 0.1, 1e6);
  visitor.Field("retry_pause_s", retry_pause_s, 0.0, 60.0);
  visitor.Field("attempts", attempts, 1, 100000);
  visitor.Field("patience_s", patience_s, 0.0, 3600.0);
  visitor.Choice("order", order, {"arrival", "queue"});
  visitor.Section("interaction", interaction);
}

const std::vector<std::string>& OperatorKinds() {
  static const std::vector<std::string> kinds{"careful", "hasty", "wrong", "silent"};
  return kinds;
}

SyntheticOperatorParameters ParametersOfKind(const std::string& kind) {
  SyntheticOperatorParameters person;
  if (kind == "hasty") {
    person.reader.edit_probability = 0.5;
    person.reader.decay_cells = 4.0;
    person.reader.path_removal_probability = 0.6;
    person.reader.misplacement_probability = 0.3;
    person.reader.lapse_probability = 0.3;
    person.reader.guess_probability = 0.05;
    person.reader.edit_limit = 2;
    person.planner.horizon = "next_goal";
    person.steering.reaction_steps = 2;
    person.steering.slip_probability = 0.04;
    person.steering.overshoot_probability = 0.1;
  } else if (kind == "wrong") {
    person.reader.edit_probability = 0.0;
    person.reader.path_removal_probability = 0.0;
    person.reader.far_centre_probability = 0.0;
    person.reader.lapse_probability = 0.0;
    person.reader.guess_probability = 1.0;
    person.planner.horizon = "away";
  } else {
    person.silent = kind == "silent";
    DEMAND(kind == "careful" || kind == "silent", kind);
  }
  return person;
}

}  // namespace conav::operators
