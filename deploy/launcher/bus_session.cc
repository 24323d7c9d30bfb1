#include "launcher/bus_session.h"

#include <fmt/core.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <utility>

#include "common/bus/backend.h"
#include "common/msg/convert.h"

namespace conav::launcher {
namespace {

constexpr auto kConvert = [](const auto& message) { return ToDomain(message); };

template <class T, class Record>
bool TakeInto(bus::Subscriber<T>& subscriber, Record& record) {
  const auto values = subscriber.TakeValid(kConvert);
  for (const auto& value : values) conav::launcher::Record(record, value);
  return !values.empty();
}

bool TakeStates(RobotStateTopics& topics, RobotRecord& robot) {
  bool received = false;
  for (const auto& state : topics.TakeStamped()) {
    received = IsNewer(robot, state.value) || received;
    Record(robot, state.value);
  }
  return received;
}

bool TakeMap(bus::Subscriber<nav_msgs::msg::OccupancyGrid>& subscriber,
             std::optional<OccupancyGrid>& map, double* cell_size_m = nullptr) {
  auto updates = subscriber.TakeValid(kConvert);
  if (updates.empty()) return false;
  map = std::move(updates.back().cells);
  if (cell_size_m != nullptr) *cell_size_m = updates.back().cell_size_m;
  return true;
}

using std::chrono::steady_clock;

// Discovery on one machine takes a few milliseconds, over a network a few hundred.
constexpr std::chrono::milliseconds kListenTime{600};
constexpr int kDomainsTried = 40;

std::optional<int> WantedDomain(const DemoOptions& options) {
  if (options.domain) return options.domain;
  const char* text = std::getenv("CONAV_DOMAIN");
  if (text == nullptr) return std::nullopt;
  char* end = nullptr;
  const long domain = std::strtol(text, &end, 10);
  if (*text == '\0' || *end != '\0' || domain < 0 || domain > 232) {
    throw UsageError(fmt::format("CONAV_DOMAIN={}: not a DDS domain (0 to 232)", text));
  }
  return static_cast<int>(domain);
}

std::string ListenForRobots(BusSession& session) {
  const auto deadline = steady_clock::now() + kListenTime;
  while (steady_clock::now() < deadline) {
    const std::string robot = session.observer->published_robot();
    if (!robot.empty()) return robot;
    session.participant->Wait(std::chrono::milliseconds(20));
  }
  return "";
}

// Why the domain is not available; empty when `session` has it.
std::string TryDomain(const DemoOptions& options, int domain, Episode& episode,
                      std::optional<BusSession>& session) {
  auto lease = DomainLease::TryAcquire(domain);
  if (!lease)
    return fmt::format("DDS domain {} is taken by another conav demo on this machine", domain);
  session.emplace(JoinKeptDomain(options, *std::move(lease), episode));
  const std::string robot = ListenForRobots(*session);
  if (robot.empty()) return "";
  session.reset();
  return fmt::format("DDS domain {} is taken: another conav publishes robot {} there", domain,
                     robot);
}

}  // namespace

RunObserver::RobotTopics::RobotTopics(bus::Participant& participant, RobotRecord& robot)
    : record(robot),
      states(participant, robot.name),
      snapshots(participant, bus::kSnapshot, robot.name),
      guidances(participant, bus::kGuidance, robot.name),
      reports(participant, bus::kSearchReport, robot.name) {}

bool RunObserver::RobotTopics::Take() {
  bool received = TakeInto(snapshots, record);
  received = TakeStates(states, record) || received;
  received = TakeInto(guidances, record) || received;
  return TakeInto(reports, record) || received;
}

RunObserver::WorldTopics::WorldTopics(bus::Participant& participant, WorldRecord& world)
    : record(world),
      beliefs(participant, bus::kBelief, world.name),
      truths(participant, bus::kTruth, world.name),
      initial_maps(participant, bus::kInitialMap, world.name) {}

bool RunObserver::WorldTopics::Take() {
  bool received = TakeInto(beliefs, record);
  received = TakeMap(truths, record.truth, &record.cell_size_m) || received;
  if (!record.first_truth) record.first_truth = record.truth;
  return TakeMap(initial_maps, record.initial_map) || received;
}

RunObserver::RunObserver(bus::Participant& participant, Episode& episode)
    : episode_(episode),
      leases_(participant, bus::kPlannerLease),
      events_(participant, bus::kOperatorEvent) {
  for (RobotRecord& robot : episode.robots) robots_.emplace_back(participant, robot);
  for (WorldRecord& world : episode.worlds) worlds_.emplace_back(participant, world);
}

bool RunObserver::Take() {
  bool received = TakeInto(events_, episode_);
  for (RobotTopics& robot : robots_) received = robot.Take() || received;
  for (WorldTopics& world : worlds_) received = world.Take() || received;
  return received;
}

std::vector<PlannerLease> RunObserver::TakeLeases() { return leases_.TakeValid(kConvert); }

std::string RunObserver::published_robot() const {
  for (const RobotTopics& robot : robots_) {
    if (robot.states.matched_publishers() > 0) return robot.record.name;
  }
  return "";
}

bus::ParticipantOptions BusOptions(const DemoOptions& options, int domain,
                                   std::optional<bus::Vendor> vendor) {
  bus::ParticipantOptions bus;
  bus.vendor = vendor;
  bus.domain_id = domain;
  bus.interface = options.interface;
  bus.peers = options.peers;
  bus.ros_distribution = options.ros;
  bus.role = "launcher";
  return bus::Resolve(std::move(bus));
}

BusSession JoinKeptDomain(const DemoOptions& options, DomainLease lease, Episode& episode) {
  const auto vendor = VendorOfService(options.dds)->at("launcher");
  const bus::ParticipantOptions bus = BusOptions(options, lease.domain(), vendor);
  auto participant = std::make_unique<bus::Participant>("conav_launcher", bus);
  std::unique_ptr<LauncherNode> node;
  if (bus.ros_distribution != bus::RosDistribution::kNone) {
    node = std::make_unique<LauncherNode>(*participant);
  }
  auto observer = std::make_unique<RunObserver>(*participant, episode);
  return {std::move(lease), std::move(participant), std::move(node), std::move(observer)};
}

BusSession JoinFreeDomain(const DemoOptions& options, Episode& episode) {
  const std::optional<int> wanted = WantedDomain(options);
  std::optional<BusSession> session;
  std::string refusal;
  const int first = wanted.value_or(0);
  const int last = wanted ? first : kDomainsTried - 1;
  for (int domain = first; domain <= last; ++domain) {
    refusal = TryDomain(options, domain, episode, session);
    if (refusal.empty()) return *std::move(session);
  }
  throw UsageError(refusal + "; choose another with --domain");
}

}  // namespace conav::launcher
