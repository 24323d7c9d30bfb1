#include "launcher/recorder.h"

#include "common/protocol/convert.h"

namespace conav::launcher {
namespace {

constexpr auto kConvert = [](const auto& message) { return ToDomain(message); };

template <class T, class Record>
bool TakeInto(bus::Subscriber<T>& subscriber, Record& record) {
  const auto values = subscriber.TakeValid(kConvert);
  for (const auto& value : values) conav::launcher::Record(record, value);
  return !values.empty();
}

bool TakeStates(bus::Subscriber<conav_msgs::msg::RobotState>& subscriber, RobotRecord& robot) {
  bool news = false;
  for (const RobotState& state : subscriber.TakeValid(kConvert)) {
    news = IsNews(robot, state) || news;
    Record(robot, state);
  }
  return news;
}

bool TakeMap(bus::Subscriber<nav_msgs::msg::OccupancyGrid>& subscriber,
             std::optional<OccupancyGrid>& map) {
  auto updates = subscriber.TakeValid(kConvert);
  if (updates.empty()) return false;
  map = std::move(updates.back().cells);
  return true;
}

}  // namespace

Recorder::RobotTopics::RobotTopics(bus::Participant& participant, RobotRecord& robot)
    : record(robot),
      states(participant, bus::kRobotState, robot.name),
      snapshots(participant, bus::kSnapshot, robot.name),
      guidances(participant, bus::kGuidance, robot.name),
      reports(participant, bus::kSearchReport, robot.name) {}

bool Recorder::RobotTopics::Take() {
  bool news = TakeInto(snapshots, record);
  news = TakeStates(states, record) || news;
  news = TakeInto(guidances, record) || news;
  return TakeInto(reports, record) || news;
}

Recorder::WorldTopics::WorldTopics(bus::Participant& participant, WorldRecord& world)
    : record(world),
      beliefs(participant, bus::kBelief, world.name),
      truths(participant, bus::kTruth, world.name),
      initial_maps(participant, bus::kInitialMap, world.name) {}

bool Recorder::WorldTopics::Take() {
  bool news = TakeInto(beliefs, record);
  news = TakeMap(truths, record.truth) || news;
  return TakeMap(initial_maps, record.initial_map) || news;
}

Recorder::Recorder(bus::Participant& participant, Episode& episode)
    : leases_(participant, bus::kPlannerLease) {
  for (RobotRecord& robot : episode.robots) robots_.emplace_back(participant, robot);
  for (WorldRecord& world : episode.worlds) worlds_.emplace_back(participant, world);
}

bool Recorder::Take() {
  bool news = false;
  for (RobotTopics& robot : robots_) news = robot.Take() || news;
  for (WorldTopics& world : worlds_) news = world.Take() || news;
  return news;
}

std::vector<PlannerLease> Recorder::TakeLeases() { return leases_.TakeValid(kConvert); }

std::string Recorder::published_robot() const {
  for (const RobotTopics& robot : robots_) {
    if (robot.states.matched_publishers() > 0) return robot.record.name;
  }
  return "";
}

}  // namespace conav::launcher
