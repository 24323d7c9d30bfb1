#include <fmt/core.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/msg/convert.h"
#include "common/runtime/text.h"
#include "common/service/diagnostics.h"
#include "common/service/robot_list.h"
#include "operator/console/console_messages.h"
#include "operator/recording/mcap_file.h"
#include "operator/replay/timeline.h"

namespace conav::operators {
namespace {

/// What conav 0.1 called bus::kStopOrder; its recordings stay readable.
constexpr bus::Topic<conav_msgs::msg::StopOrder> kStopOrderOf01{"/{}/hold", bus::kLatchedQos};

/// Takes up a serialised message that was recorded at `wall_s`; false when it is not one of the
/// topic's, or says what cannot be.
using TakeUp = std::function<bool(std::span<const std::uint8_t> message, double wall_s)>;

class Topics {
 public:
  /// `use` gets the message as the bus carries it and gives false where it is refused.
  template <class T, class Use>
  void On(const bus::Topic<T>& topic, const std::string& entity, Use use) {
    take_up_[topic.NameFor(entity)] = [use](std::span<const std::uint8_t> data, double wall_s) {
      T message;
      return bus::TypeSupportOf<T>().deserialize(data, &message) && use(message, wall_s);
    };
  }
  /// `use` gets the domain value.
  template <class T, class Use>
  void OnValue(const bus::Topic<T>& topic, const std::string& entity, Use use) {
    On(topic, entity, [use](const T& message, double wall_s) {
      auto value = ToDomain(message);
      if (value) use(*std::move(value), wall_s);
      return value.has_value();
    });
  }
  std::map<std::string, TakeUp> Take() && { return std::move(take_up_); }

 private:
  std::map<std::string, TakeUp> take_up_;
};

void AddRobot(Topics& topics, const std::string& robot, TimelineBuilder& builder) {
  const auto receive = [&builder](auto value, double wall_s) {
    builder.Receive(wall_s, std::move(value));
  };
  const auto join = std::make_shared<GoalsJoin>();
  const auto receive_joined = [&builder, join](auto value, double wall_s) {
    if (auto state = join->Receive(std::move(value))) builder.Receive(wall_s, *std::move(state));
  };
  topics.OnValue(bus::kRobotState, robot, receive_joined);
  topics.OnValue(bus::kRobotGoals, robot, receive_joined);
  topics.OnValue(bus::kGuidance, robot, receive);
  topics.OnValue(bus::kSearchReport, robot, receive);
  topics.OnValue(bus::kSnapshot, robot, receive);
  topics.OnValue(bus::kStopOrder, robot, receive);
  topics.OnValue(kStopOrderOf01, robot, receive);
  topics.OnValue(bus::kRobotMap, robot, [&builder, robot](MapUpdate map, double wall_s) {
    builder.ReceiveSeen(wall_s, robot, std::move(map));
  });
  topics.OnValue(bus::kGoalPose, robot, [&builder, robot](Position goal, double wall_s) {
    builder.ReceiveGoalPose(wall_s, robot, goal);
  });
  topics.On(bus::kPlan, robot, [&builder, robot](const nav_msgs::msg::Path& path, double wall_s) {
    const auto stamp = ToDomain(path.header().stamp());
    builder.ReceivePlan(wall_s, robot, stamp.value_or(SimTime{}), ToPositions(path));
    return true;
  });
  topics.On(bus::kCameraImage, robot,
            [&builder, robot](const sensor_msgs::msg::CompressedImage& image, double wall_s) {
              const auto stamp = ToDomain(image.header().stamp());
              builder.ReceiveFrame(wall_s, {robot, stamp.value_or(SimTime{}), image.data()});
              return true;
            });
}

void AddWorld(Topics& topics, const std::string& world, TimelineBuilder& builder) {
  topics.OnValue(bus::kInitialMap, world, [&builder, world](MapUpdate map, double wall_s) {
    builder.ReceiveInitialMap(wall_s, world, std::move(map));
  });
  topics.OnValue(bus::kTruth, world, [&builder, world](MapUpdate truth, double wall_s) {
    builder.ReceiveTruth(wall_s, world, std::move(truth));
  });
  topics.OnValue(bus::kBelief, world, [&builder](Belief belief, double wall_s) {
    builder.Receive(wall_s, std::move(belief));
  });
}

/// For each topic that a console receives of these robots (their worlds by name), by topic.
/// `builder` outlives it.
std::map<std::string, TakeUp> RecordedTopics(
    const std::map<std::string, std::string>& world_of_robot, TimelineBuilder& builder) {
  Topics topics;
  std::set<std::string> worlds;
  for (const auto& [robot, world] : world_of_robot) {
    AddRobot(topics, robot, builder);
    worlds.insert(world);
  }
  for (const std::string& world : worlds) AddWorld(topics, world, builder);
  const auto receive = [&builder](auto value, double wall_s) {
    builder.Receive(wall_s, std::move(value));
  };
  topics.OnValue(bus::kAttentionQueue, "", receive);
  topics.OnValue(bus::kOperatorEvent, "", receive);
  topics.On(bus::kDiagnostics, "", [&builder](const auto& array, double wall_s) {
    for (const ReportedHealth& health : HealthOf(array)) {
      const auto level = static_cast<console::Level>(health.level);
      builder.Receive(wall_s, ServiceHealth{health.process, level, health.message});
    }
    return true;
  });
  return std::move(topics).Take();
}

constexpr double kNanosecond = 1e-9;

/// What the recorder wrote of the run.
bag::TextMap FactsOf(const bag::McapReader& reader) {
  for (const bag::Metadata& metadata : reader.metadata()) {
    if (metadata.name == "conav") return metadata.values;
  }
  return {};
}

std::string FactOf(const bag::TextMap& facts, const std::string& name) {
  const auto found = facts.find(name);
  return found == facts.end() ? "" : found->second;
}

/// "world/robot" of each.
std::vector<std::string> RobotsOf(const bag::TextMap& facts) {
  std::istringstream words(FactOf(facts, "robots"));
  std::vector<std::string> robots;
  for (std::string entry; words >> entry;) robots.push_back(entry);
  return robots;
}

Result<std::map<std::string, std::string>> WorldsOf(const std::vector<std::string>& robots,
                                                    const std::filesystem::path& file) {
  try {
    return WorldOfRobot("recorder", robots);
  } catch (const StartupError& error) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: not a recording of conav's: {}", file.string(), error.what()));
  }
}

console::Session SessionOfRun(const bag::TextMap& facts, const std::vector<std::string>& robots) {
  console::Session session = SessionOf(robots, Readable(FactOf(facts, "method")));
  session.set_name(Readable(FactOf(facts, "run")));
  return session;
}

/// The fields of a message definition, without comments and constants.
std::string FieldsOf(std::string_view definition) {
  std::istringstream lines{std::string(definition)};
  std::string fields;
  for (std::string line; std::getline(lines, line);) {
    line = line.substr(0, line.find('#'));
    line.erase(line.find_last_not_of(' ') + 1);
    if (!line.empty() && line.find('=') == std::string::npos) fields += line + '\n';
  }
  return fields;
}

/// The topics of `known` whose messages had other fields when they were recorded.
std::set<std::string> TopicsOfOtherVersions(const bag::McapReader& reader,
                                            const std::map<std::string, TakeUp>& known) {
  std::set<std::string> others;
  for (const bag::RecordedTopic& topic : reader.topics()) {
    const auto ours = bag::ConavSchemas().find(topic.schema.name);
    if (!known.contains(topic.channel.topic) || ours == bag::ConavSchemas().end()) continue;
    if (FieldsOf(topic.schema.text) != FieldsOf(ours->second)) others.insert(topic.channel.topic);
  }
  return others;
}

/// Reads on until the end; a damaged chunk costs what was in it.
void ReadAll(bag::McapReader& reader, const std::map<std::string, TakeUp>& topics,
             std::vector<std::string>& warnings) {
  if (!reader.cut_off().empty()) warnings.push_back(reader.cut_off());
  const std::set<std::string> others = TopicsOfOtherVersions(reader, topics);
  if (!others.empty()) {
    warnings.push_back(fmt::format(
        "{}: recorded by another version of conav, with other fields; replay it with that version",
        Join(others, ", ")));
  }
  std::uint64_t refused = 0;
  std::uint64_t taken = 0;  // bytes, all of which stay in memory
  for (;;) {
    const auto next = reader.Next();
    if (!next) {
      warnings.push_back(next.error().text);
      continue;
    }
    if (!*next) break;
    const bag::RecordedMessage& message = **next;
    const auto take_up = topics.find(message.topic->channel.topic);
    if (take_up == topics.end() || others.contains(message.topic->channel.topic)) continue;
    taken += message.data.size();
    if (taken > kReadLimit) {
      warnings.push_back(fmt::format("only the first {} MiB are shown", kReadLimit >> 20));
      break;
    }
    const double wall_s = static_cast<double>(message.log_time) * kNanosecond;
    if (!take_up->second(message.data, wall_s)) ++refused;
  }
  if (refused == 0) return;
  warnings.push_back(
      fmt::format("{} messages were left out: not what their topics carry", refused));
}

}  // namespace

Result<RecordedRun> ReadRun(const std::filesystem::path& file) {
  auto reader = bag::McapReader::Open(file);
  if (!reader) return tl::unexpected(reader.error());
  const bag::TextMap facts = FactsOf(*reader);
  const std::vector<std::string> robots = RobotsOf(facts);
  const auto world_of_robot = WorldsOf(robots, file);
  if (!world_of_robot) return tl::unexpected(world_of_robot.error());
  TimelineBuilder builder(SessionOfRun(facts, robots));
  RecordedRun run;
  run.name = FactOf(facts, "run");
  ReadAll(*reader, RecordedTopics(*world_of_robot, builder), run.warnings);
  run.timeline = std::move(builder).Finish();
  if (run.timeline.moments.empty()) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: nothing of these robots is in it", file.string()));
  }
  return run;
}

}  // namespace conav::operators
