#include "operator/replay/recorded_topics.h"

#include <set>
#include <utility>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/protocol/convert.h"
#include "common/service/reported_health.h"

namespace conav::operators {
namespace {

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
  const auto hear = [&builder](auto value, double wall_s) {
    builder.Hear(wall_s, std::move(value));
  };
  topics.OnValue(bus::kRobotState, robot, hear);
  topics.OnValue(bus::kGuidance, robot, hear);
  topics.OnValue(bus::kSearchReport, robot, hear);
  topics.OnValue(bus::kSnapshot, robot, hear);
  topics.OnValue(bus::kHoldOrder, robot, hear);
  topics.OnValue(bus::kRobotMap, robot, [&builder, robot](MapUpdate map, double wall_s) {
    builder.HearSeen(wall_s, robot, std::move(map));
  });
  topics.OnValue(bus::kGoalPose, robot, [&builder, robot](Position goal, double wall_s) {
    builder.HearGoalPose(wall_s, robot, goal);
  });
  topics.On(bus::kPlan, robot, [&builder, robot](const nav_msgs::msg::Path& path, double wall_s) {
    const auto stamp = ToDomain(path.header().stamp());
    builder.HearPlan(wall_s, robot, stamp.value_or(SimTime{}), ToPositions(path));
    return true;
  });
  topics.On(bus::kCameraImage, robot,
            [&builder, robot](const sensor_msgs::msg::CompressedImage& image, double wall_s) {
              const auto stamp = ToDomain(image.header().stamp());
              builder.HearFrame(wall_s, {robot, stamp.value_or(SimTime{}), image.data()});
              return true;
            });
}

void AddWorld(Topics& topics, const std::string& world, TimelineBuilder& builder) {
  topics.OnValue(bus::kInitialMap, world, [&builder, world](MapUpdate map, double wall_s) {
    builder.HearInitialMap(wall_s, world, std::move(map));
  });
  topics.OnValue(bus::kTruth, world, [&builder, world](MapUpdate truth, double wall_s) {
    builder.HearTruth(wall_s, world, std::move(truth));
  });
  topics.OnValue(bus::kBelief, world, [&builder](Belief belief, double wall_s) {
    builder.Hear(wall_s, std::move(belief));
  });
}

}  // namespace

std::map<std::string, TakeUp> RecordedTopics(
    const std::map<std::string, std::string>& world_of_robot, TimelineBuilder& builder) {
  Topics topics;
  std::set<std::string> worlds;
  for (const auto& [robot, world] : world_of_robot) {
    AddRobot(topics, robot, builder);
    worlds.insert(world);
  }
  for (const std::string& world : worlds) AddWorld(topics, world, builder);
  const auto hear = [&builder](auto value, double wall_s) {
    builder.Hear(wall_s, std::move(value));
  };
  topics.OnValue(bus::kAttentionQueue, "", hear);
  topics.OnValue(bus::kOperatorRequest, "", hear);
  topics.OnValue(bus::kOperatorReply, "", hear);
  topics.On(bus::kDiagnostics, "", [&builder](const auto& array, double wall_s) {
    for (const ReportedHealth& health : HealthOf(array)) {
      const auto level = static_cast<console::Level>(health.level);
      builder.Hear(wall_s, ServiceHealth{health.process, level, health.message});
    }
    return true;
  });
  return std::move(topics).Take();
}

}  // namespace conav::operators
