#include "operator/replay/recording_reader.h"

#include <fmt/format.h>

#include <sstream>
#include <utility>

#include "common/runtime/utf8.h"
#include "common/service/robot_list.h"
#include "operator/bag/mcap_reader.h"
#include "operator/console/console_messages.h"
#include "operator/replay/recorded_topics.h"

namespace conav::operators {
namespace {

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

/// Reads on until the end; a damaged chunk costs what was in it.
class Reading {
 public:
  Reading(bag::McapReader reader, std::map<std::string, TakeUp> topics)
      : reader_(std::move(reader)), topics_(std::move(topics)) {}

  void ReadAll(RecordedRun& run) {
    if (!reader_.cut_off().empty()) run.warnings.push_back(reader_.cut_off());
    while (ReadOne(run)) {
    }
    if (refused_ > 0) {
      run.warnings.push_back(
          fmt::format("{} messages were left out: not what their topics carry", refused_));
    }
  }

 private:
  bool ReadOne(RecordedRun& run) {
    const auto next = reader_.Next();
    if (!next) {
      run.warnings.push_back(next.error().text);
      return true;
    }
    if (!*next) return false;
    const bag::RecordedMessage& message = **next;
    const auto take_up = topics_.find(message.topic->channel.topic);
    if (take_up == topics_.end()) return true;
    const double wall_s = static_cast<double>(message.log_time) * kNanosecond;
    if (!take_up->second(message.data, wall_s)) ++refused_;
    return true;
  }

  bag::McapReader reader_;
  std::map<std::string, TakeUp> topics_;
  std::uint64_t refused_ = 0;
};

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
  Reading(*std::move(reader), RecordedTopics(*world_of_robot, builder)).ReadAll(run);
  run.timeline = std::move(builder).Finish();
  if (run.timeline.moments.empty()) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: nothing of these robots is in it", file.string()));
  }
  return run;
}

}  // namespace conav::operators
