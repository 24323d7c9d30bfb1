#include "operator/supervision/ros_services.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "common/bus/subscriber.h"
#include "common/msg/robot.h"
#include "common/runtime/clock.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav::operators {
namespace {

constexpr double kValidS = 5.0;

using Trigger = bus::ServiceServer<std_srvs::srv::Trigger_Request, std_srvs::srv::Trigger_Response>;

/// As map_saver of Nav2 writes them in mode trinary.
char Shade(std::int8_t occupancy) {
  constexpr char kFree = '\xfe';
  constexpr char kUnknown = '\xcd';
  if (occupancy < 0) return kUnknown;
  if (occupancy <= 25) return kFree;
  return occupancy >= 65 ? '\0' : kUnknown;
}

std::string ToPgm(const nav_msgs::msg::OccupancyGrid& map) {
  const std::size_t width = map.info().width();
  const std::size_t height = map.info().height();
  std::string pgm = fmt::format("P5\n{} {}\n255\n", width, height);
  for (std::size_t row = 0; row < height; ++row) {
    const std::size_t from_south = height - 1 - row;
    for (std::size_t column = 0; column < width; ++column) {
      pgm.push_back(Shade(map.data()[from_south * width + column]));
    }
  }
  return pgm;
}

}  // namespace

Result<void> SaveMap(const nav_msgs::msg::OccupancyGrid& map, const std::filesystem::path& folder,
                     const std::string& name) {
  if (!IsEntityName(name)) {
    return Fail(ErrorCode::kOutOfRange,
                "map_url = '" + Readable(name) + "' is not a name: 1 to 64 of A-Z a-z 0-9 _");
  }
  const auto& origin = map.info().origin().position();
  const std::string yaml = fmt::format(
      "image: {}.pgm\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0]\nnegate: 0\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.25\n",
      name, map.info().resolution(), origin.x(), origin.y());
  if (auto written = WriteFile(folder / (name + ".pgm"), ToPgm(map)); !written) return written;
  return WriteFile(folder / (name + ".yaml"), yaml);
}

struct RosServices::Robot {
  Robot(bus::Participant& participant, const std::string& robot, std::string world)
      : name(robot),
        world(std::move(world)),
        stop(participant, bus::kStopService, robot),
        resume(participant, bus::kResumeService, robot) {}

  std::string name;
  std::string world;
  Trigger stop;
  Trigger resume;
};

struct RosServices::World {
  World(bus::Participant& participant, const std::string& world)
      : name(world),
        belief_map(participant, bus::kBeliefMap, world),
        save(participant, bus::kSaveMapService, world) {}

  std::string name;
  bus::Subscriber<nav_msgs::msg::OccupancyGrid> belief_map;
  std::optional<nav_msgs::msg::OccupancyGrid> map;  // the newest
  bus::ServiceServer<nav2_msgs::srv::SaveMap_Request, nav2_msgs::srv::SaveMap_Response> save;
};

RosServices::RosServices(bus::Participant& participant,
                         const std::map<std::string, std::string>& world_of_robot,
                         std::filesystem::path map_folder)
    : map_folder_(std::move(map_folder)),
      // Above those of an earlier process: a number that was used is a repeat.
      newest_request_(static_cast<std::uint64_t>(WallSeconds() * 1e6)) {
  std::set<std::string> worlds;
  for (const auto& [robot, world] : world_of_robot) {
    robots_.push_back(std::make_unique<Robot>(participant, robot, world));
    worlds.insert(world);
  }
  for (const std::string& world : worlds) {
    worlds_.push_back(std::make_unique<World>(participant, world));
  }
}

RosServices::~RosServices() = default;

std::vector<ConsoleTopics::Asked> RosServices::Step(const ControlRegistry& control,
                                                    Clock::TimePoint now) {
  for (const auto& world : worlds_) {
    for (auto& map : world->belief_map.Take()) world->map = std::move(map);
    world->save.Serve([&](const nav2_msgs::srv::SaveMap_Request& request) {
      Result<void> saved = Fail(ErrorCode::kUnavailable, "the world has no map yet");
      if (world->map) saved = SaveMap(*world->map, map_folder_, request.map_url());
      if (saved) {
        LOG_INFO("map saved", "world", world->name, "name", request.map_url(), "folder",
                 map_folder_.string());
      } else {
        LOG_WARNING("map not saved", "world", world->name, "reason", saved.error().text);
      }
      nav2_msgs::srv::SaveMap_Response response;
      response.result(saved.has_value());
      return response;
    });
  }
  std::vector<ConsoleTopics::Asked> asked;
  const auto ask = [&](Robot& robot, Trigger& server, auto make_body, const std::string& refusal) {
    for (const auto& call : server.Take()) {
      OperatorRequest request{.client = kClient, .world = robot.world};
      request.request_id = ++newest_request_;
      request.body = make_body(robot.name);
      const auto reply = [&server, id = call.id](const OperatorReply& decision) {
        std_srvs::srv::Trigger_Response response;
        response.success(decision.accepted);
        response.message(decision.reason);
        server.Reply(id, response);
      };
      asked.push_back({reply, std::move(request), WallSeconds() + kValidS, refusal});
    }
  };
  for (const auto& robot : robots_) {
    ask(
        *robot, robot->stop,
        [](const std::string& name) {
          return StopRequest{{name}, "by a ROS 2 service"};
        },
        "");
    ask(
        *robot, robot->resume, [](const std::string& name) { return ResumeRequest{{name}}; },
        control.CheckCommand(kClient, robot->name, now));
  }
  return asked;
}

}  // namespace conav::operators
