#include "operator/recorder/topic_listeners.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>

#include "common/bus/all_topics.h"
#include "common/bus/backend.h"
#include "common/bus/type_support.h"
#include "common/service/robot_list.h"
#include "operator/recorder/offered_qos.h"

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

template <class T>
bus::Sink SinkFor(std::uint16_t channel, Arrivals& arrivals) {
  return [channel, &arrivals](void* message, bus::SourceTime) {
    const bus::TypeSupport& type = bus::TypeSupportOf<T>();
    bag::Bytes data(type.serialized_size(message));
    data.resize(type.serialize(message, data));
    arrivals.Add(channel, StampOf(*static_cast<const T*>(message)), std::move(data));
  };
}

/// Which topics a config leaves out.
class Choice {
 public:
  explicit Choice(const RecorderConfig& config)
      : streams_(config.streams), entries_(config.exclude.begin(), config.exclude.end()) {}

  bool Wants(std::string_view pattern, const std::string& name) {
    const bool excluded = IsExcluded(std::string(pattern)) | IsExcluded(name);
    const bool stream =
        std::ranges::find(bus::kStreamPatterns, pattern) != std::end(bus::kStreamPatterns);
    return !excluded && (streams_ || !stream);
  }
  /// Throws StartupError for an entry that excluded nothing.
  void CheckAllUsed() const {
    for (const std::string& entry : entries_) {
      if (used_.contains(entry)) continue;
      throw StartupError("recorder.exclude: '" + entry + "' is no topic of these robots");
    }
  }

 private:
  bool IsExcluded(const std::string& entry) {
    if (!entries_.contains(entry)) return false;
    used_.insert(entry);
    return true;
  }

  bool streams_;
  std::set<std::string> entries_;
  std::set<std::string> used_;
};

}  // namespace

TopicListeners::TopicListeners(bus::Participant& participant, const RecorderConfig& config,
                               const std::function<std::uint16_t(const TopicFacts&)>& add_channel,
                               Arrivals& arrivals) {
  Choice choice(config);
  const auto listen = [&]<class T>(const bus::Topic<T>& topic, const std::string& entity) {
    const std::string name = topic.NameFor(entity);
    if (!choice.Wants(topic.pattern, name)) return;
    const bus::TypeSupport& type = bus::TypeSupportOf<T>();
    const std::uint16_t channel =
        add_channel({name, RosName(type.name), OfferedQosText(topic.qos)});
    bus::Qos qos = topic.qos;
    qos.depth = kReaderDepth;
    readers_.push_back(
        participant.backend().CreateReader({name, type, qos}, SinkFor<T>(channel, arrivals)));
  };
  std::set<std::string> worlds;
  for (const auto& entry : WorldOfRobot("recorder", config.robots)) {
    bus::ForEachTopic(bus::kRobotTopics, [&](const auto& topic) { listen(topic, entry.first); });
    worlds.insert(entry.second);
  }
  for (const std::string& world : worlds) {
    bus::ForEachTopic(bus::kWorldTopics, [&](const auto& topic) { listen(topic, world); });
  }
  bus::ForEachTopic(bus::kSystemTopics, [&](const auto& topic) { listen(topic, ""); });
  choice.CheckAllUsed();
}

TopicListeners::~TopicListeners() = default;

std::uint64_t TopicListeners::malformed() const {
  std::uint64_t sum = 0;
  for (const auto& reader : readers_) sum += reader->malformed();
  return sum;
}

}  // namespace conav::recorder
