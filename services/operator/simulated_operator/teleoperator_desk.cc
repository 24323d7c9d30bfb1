#include "operator/simulated_operator/teleoperator_desk.h"

#include <set>

#include "common/protocol/convert.h"
#include "operator/simulated_operator/ask_through.h"

namespace conav::operators {
namespace {

constexpr auto kConvert = [](const auto& message) { return ToDomain(message); };

}  // namespace

struct TeleoperatorDesk::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name)
      : state(participant, bus::kRobotState, name), snapshot(participant, bus::kSnapshot, name) {}

  bus::Subscriber<conav_msgs::msg::RobotState> state;
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshot;
};

struct TeleoperatorDesk::WorldLink {
  WorldLink(bus::Participant& participant, const std::string& name)
      : name(name),
        belief(participant, bus::kBelief, name),
        belief_map(participant, bus::kBeliefMap, name) {}

  std::string name;
  bus::Subscriber<conav_msgs::msg::BeliefMap> belief;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> belief_map;
};

TeleoperatorDesk::TeleoperatorDesk(bus::Participant& participant, const Clock& clock,
                                   OperatorClient& client,
                                   const SyntheticOperatorParameters& parameters,
                                   std::uint64_t seed,
                                   const std::map<std::string, std::string>& world_of_robot)
    : clock_(clock), client_(client), person_(parameters, seed, world_of_robot) {
  std::set<std::string> worlds;
  for (const auto& [robot, world] : world_of_robot) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot));
    worlds.insert(world);
  }
  for (const std::string& world : worlds) {
    worlds_.push_back(std::make_unique<WorldLink>(participant, world));
  }
}

TeleoperatorDesk::~TeleoperatorDesk() = default;

void TeleoperatorDesk::TakeIn() {
  for (const auto& world : worlds_) {
    for (const Belief& belief : world->belief.TakeValid(kConvert)) person_.Hear(belief);
    for (const MapUpdate& map : world->belief_map.TakeValid(kConvert)) {
      person_.HearCellSize(world->name, map.cell_size_m);
    }
  }
  for (const auto& robot : robots_) {
    for (const RobotState& state : robot->state.TakeValid(kConvert)) person_.Hear(state);
    for (const Picture& picture : robot->snapshot.TakeValid(kConvert)) person_.Hear(picture);
  }
}

void TeleoperatorDesk::Step() {
  TakeIn();
  AskThrough(client_, person_, clock_);
}

}  // namespace conav::operators
