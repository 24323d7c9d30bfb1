#include "operator/recording/raw_topics.h"

#include <fmt/core.h>

#include <map>
#include <set>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/service/robot_list.h"

namespace conav::recorder {
namespace {

/// A reader never holds a writer up and takes messages as they come, so that no topic needs more.
constexpr int kReaderDepth = 100;
constexpr std::int64_t kNanoseconds = 1'000'000'000;

/// "conav_msgs::msg::dds_::RobotState_" as "conav_msgs/msg/RobotState".
std::string RosName(std::string_view dds_name) {
  constexpr std::string_view kBetween = "::msg::dds_::";
  const auto between = dds_name.find(kBetween);
  const auto name = dds_name.substr(between + kBetween.size());
  return fmt::format("{}/msg/{}", dds_name.substr(0, between), name.substr(0, name.size() - 1));
}

/// The stamp of a message's header, if it has one.
template <class T>
std::optional<std::uint64_t> StampOf(const T& message) {
  if constexpr (requires { message.header().stamp(); }) {
    const auto& stamp = message.header().stamp();
    if (stamp.sec() < 0) return std::nullopt;
    return static_cast<std::uint64_t>(stamp.sec() * kNanoseconds + stamp.nanosec());
  }
  return std::nullopt;
}

template <class Stamp>
std::int64_t Nanoseconds(const Stamp& stamp) {
  return stamp.sec() * kNanoseconds + stamp.nanosec();
}

/// Of messages that come often, which to keep: one per 0.25 s of their time, the simulator's control
/// step, which is the rate when nobody asks for more. Time that runs back starts again.
class Thinning {
 public:
  bool Keeps(const rosgraph_msgs::msg::Clock& message) {
    return Keeps("", Nanoseconds(message.clock()));
  }
  bool Keeps(const nav_msgs::msg::Odometry& message) {
    return Keeps("", Nanoseconds(message.header().stamp()));
  }
  /// By the first frame: several simulators share /tf, each with its own time.
  bool Keeps(const tf2_msgs::msg::TFMessage& message) {
    if (message.transforms().empty()) return true;
    const auto& first = message.transforms().front();
    return Keeps(first.child_frame_id(), Nanoseconds(first.header().stamp()));
  }
  template <class T>
  bool Keeps(const T&) {
    return true;
  }

 private:
  static constexpr std::int64_t kPeriodNs = kNanoseconds / 4;

  bool Keeps(const std::string& source, std::int64_t stamp_ns) {
    const auto [kept, is_new] = kept_.try_emplace(source, stamp_ns);
    const std::int64_t since = stamp_ns - kept->second;
    if (!is_new && since >= 0 && since < kPeriodNs) return false;
    kept->second = stamp_ns;
    return true;
  }

  std::map<std::string, std::int64_t> kept_;  // stamp of the last, by source
};

template <class T>
std::unique_ptr<bus::Reader> Listen(bus::Participant& participant, const std::string& name,
                                    bus::Qos qos, Rate rate, RawSink sink) {
  qos.depth = kReaderDepth;
  const bool thins = rate == Rate::kThinned;
  if (thins) qos.demand = bus::Demand::kSparse;
  const bus::TypeSupport& type = bus::TypeSupportOf<T>();
  return participant.backend().CreateReader(
      {name, type, qos}, [&type, thins, thinning = Thinning(), sink = std::move(sink)](
                             void* message, const bus::Origin& origin) mutable {
        if (thins && !thinning.Keeps(*static_cast<const T*>(message))) return;
        std::vector<std::uint8_t> data(type.serialized_size(message));
        data.resize(type.serialize(message, data));
        sink(std::move(data), StampOf(*static_cast<const T*>(message)), origin.writer);
      });
}

template <class T>
RawTopic Raw(const bus::Topic<T>& topic, const std::string& entity) {
  const std::string name = topic.NameFor(entity);
  return {name,
          RosName(bus::TypeSupportOf<T>().name),
          topic.pattern,
          topic.direction,
          topic.qos,
          [name, qos = topic.qos](bus::Participant& participant, Rate rate, RawSink sink) {
            return Listen<T>(participant, name, qos, rate, std::move(sink));
          }};
}

}  // namespace

std::vector<RawTopic> RawTopicsOf(const std::string& service,
                                  const std::vector<std::string>& robots) {
  std::vector<RawTopic> topics;
  std::set<std::string> worlds;
  // The recording has the full ones.
  const auto add = [&](const auto& topic, const std::string& entity) {
    const bool is_for_links =
        std::ranges::find(bus::kLinkPatterns, topic.pattern) != bus::kLinkPatterns.end();
    if (!is_for_links) topics.push_back(Raw(topic, entity));
  };
  for (const auto& entry : WorldOfRobot(service, robots, NoRobots::kAllowed)) {
    bus::ForEachRobotTopic([&](const auto& topic) { add(topic, entry.first); });
    worlds.insert(entry.second);
  }
  for (const std::string& world : worlds) {
    bus::ForEachWorldTopic([&](const auto& topic) { add(topic, world); });
  }
  bus::ForEachSystemTopic([&](const auto& topic) { topics.push_back(Raw(topic, "")); });
  return topics;
}

}  // namespace conav::recorder
