#include "sim/checkpoint_topics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "common/bus/type_support.h"
#include "common/msg/convert.h"
#include "common/runtime/file.h"

namespace conav::sim {
namespace {

constexpr std::chrono::seconds kPeriod{1};
constexpr std::uint64_t kStepsOfStates = 2;  // the state of a robot that waits comes each 0.5 s
constexpr double kLongestPauseS = 3600.0;
constexpr const char* kKind = "conav-sim checkpoint 1";

/// A part is its length, 8 bytes, and its bytes.
void Append(std::string& out, std::string_view part) {
  const std::uint64_t size = part.size();
  out.append(reinterpret_cast<const char*>(&size), sizeof size);
  out += part;
}

template <class T>
std::string Serialised(const T& message) {
  const bus::TypeSupport& type = bus::TypeSupportOf<T>();
  std::string bytes(type.serialized_size(&message), '\0');
  bytes.resize(
      type.serialize(&message, {reinterpret_cast<std::uint8_t*>(bytes.data()), bytes.size()}));
  return bytes;
}

template <class T>
auto Deserialised(std::string_view bytes) -> decltype(ToDomain(std::declval<const T&>())) {
  T message;
  if (!bus::TypeSupportOf<T>().deserialize(
          {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, &message)) {
    return Fail(ErrorCode::kMalformed, "cut off");
  }
  return ToDomain(message);
}

/// Takes the parts of a file one after the other.
class Parts {
 public:
  explicit Parts(std::string_view rest) : rest_(rest) {}

  /// Empty where the file ends.
  std::string_view Take() {
    std::uint64_t size = 0;
    if (rest_.size() < sizeof size) return {};
    std::memcpy(&size, rest_.data(), sizeof size);
    rest_.remove_prefix(sizeof size);
    const std::string_view part = rest_.substr(0, size);
    rest_.remove_prefix(part.size());
    return part;
  }
  template <class T>
  auto TakeMessage() {
    return Deserialised<T>(Take());
  }

 private:
  std::string_view rest_;
};

/// The robots of `episode`; a map that was read from a file may be another one by now.
Result<Episode::Moment> Read(Parts& parts, const Episode& episode) {
  Episode::Moment moment;
  for (int robot = 0; robot < episode.robot_count(); ++robot) {
    auto goals = parts.TakeMessage<conav_msgs::msg::RobotGoals>();
    auto state = parts.TakeMessage<conav_msgs::msg::RobotState>();
    auto map = parts.TakeMessage<nav_msgs::msg::OccupancyGrid>();
    if (!state) return tl::unexpected(state.error());
    if (!map) return tl::unexpected(map.error());
    const OccupancyGrid& cells = episode.map(robot).cells;
    if (map->cells.rows() != cells.rows() || map->cells.columns() != cells.columns() ||
        !cells.Contains(state->cell)) {
      return Fail(ErrorCode::kMalformed, "another map");
    }
    if (state->goals_stamp != SimTime{}) {  // it keeps its goals
      if (!goals) return tl::unexpected(goals.error());
      GoalsJoin join;
      (void)join.Receive(*state);
      const auto joined = join.Receive(*goals);
      if (!joined) return Fail(ErrorCode::kMalformed, "goals of another moment");
      *state = *joined;
    }
    moment.robots.push_back({*std::move(state), *std::move(map)});
  }
  return moment;
}

}  // namespace

void Checkpoint::Save(const Episode& episode) {
  if (file_.empty()) return;
  robots_.resize(static_cast<std::size_t>(episode.robot_count()));
  const std::uint64_t steps = episode.physics().steps();
  bool changed =
      !saved_at_ || clock_.Now() - *saved_at_ >= kPeriod || steps >= saved_steps_ + kStepsOfStates;
  for (int robot = 0; robot < episode.robot_count(); ++robot) {
    const std::uint64_t version = episode.state_version(robot);
    changed |= std::exchange(robots_[static_cast<std::size_t>(robot)].version, version) != version;
  }
  if (!changed) return;
  saved_at_ = clock_.Now();
  saved_steps_ = steps;
  std::string bytes;
  Append(bytes, kKind);
  Append(bytes, configuration_);
  Append(bytes, fmt::format("{} {}", steps, WallSeconds()));
  for (int robot = 0; robot < episode.robot_count(); ++robot) {
    RobotPart& part = robots_[static_cast<std::size_t>(robot)];
    const RobotState state = episode.state(robot);
    if (std::exchange(part.map_stamp, state.map_stamp) != state.map_stamp) {
      part.map = Serialised(ToMessage(episode.map(robot)));
    }
    Append(bytes, Serialised(ToMessage(GoalsOf(state, episode.goal_tolerance_m()))));
    Append(bytes, Serialised(ToMessage(state)));
    Append(bytes, part.map);
  }
  Write(file_, bytes);
}

void Checkpoint::Keep(const Snapshot& picture) {
  if (!file_.empty()) Write(PictureFile(picture.robot), Serialised(ToMessage(picture)));
}

void Checkpoint::Write(const std::filesystem::path& file, const std::string& bytes) {
  if (const auto written = WriteFile(file, bytes); !written && failures_logged_.Allow()) {
    LOG_ERROR("no checkpoint", "reason", written.error().text);
  }
}

std::filesystem::path Checkpoint::PictureFile(const std::string& robot) const {
  return file_.string() + "." + robot;
}

bool Checkpoint::Restore(Episode& episode, double speed) {
  if (file_.empty()) return false;
  const auto bytes = ReadFile(file_);
  if (!bytes) return false;
  Parts parts(*bytes);
  if (parts.Take() != kKind || parts.Take() != configuration_) {
    LOG_WARNING("a checkpoint of another configuration is not used", "file", file_.string());
    return false;
  }
  std::uint64_t steps = 0;
  double wall_s = 0.0;
  const std::string time(parts.Take());
  const bool has_time = std::sscanf(time.c_str(), "%lu %lf", &steps, &wall_s) == 2;
  auto moment = Read(parts, episode);
  if (!has_time || !moment) {
    LOG_WARNING("a damaged checkpoint is not used", "file", file_.string());
    return false;
  }
  const double pause_s = std::clamp(WallSeconds() - wall_s, 0.0, kLongestPauseS);
  moment->steps = steps + static_cast<std::uint64_t>(pause_s * speed / kControlStepS);
  episode.Restore(*std::move(moment));
  LOG_INFO("goes on from the checkpoint", "file", file_.string(), "sim_s",
           episode.now().ToSeconds(), "pause_s", pause_s);
  return true;
}

std::vector<Snapshot> Checkpoint::Pictures(const Episode& episode) const {
  std::vector<Snapshot> pictures;
  for (int robot = 0; robot < episode.robot_count() && !file_.empty(); ++robot) {
    const RobotState state = episode.state(robot);
    const auto bytes = ReadFile(PictureFile(state.robot));
    if (!bytes) continue;
    auto picture = Deserialised<conav_msgs::msg::Snapshot>(*bytes);
    if (picture && picture->robot == state.robot && picture->world == state.world &&
        picture->sequence_number == state.snapshots) {
      pictures.push_back(*std::move(picture));
    }
  }
  return pictures;
}

void Checkpoint::Remove(const Episode& episode) {
  if (file_.empty()) return;
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
  for (int robot = 0; robot < episode.robot_count(); ++robot) {
    std::filesystem::remove(PictureFile(episode.state(robot).robot), ignored);
  }
}

}  // namespace conav::sim
