#include "operator/recording/segment_topics.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>

#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"

namespace conav::operators {
namespace {

std::string SessionName(const SegmentOptions& config) {
  if (!config.session.empty()) return config.session;
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return UtcTime(now, "%Y%m%d-%H%M%S");
}

SegmentCollector MakeCollector(const SegmentOptions& config, const std::string& session) {
  auto mazes = ParseMazeFacts(config.mazes);
  if (!mazes) throw StartupError("operator.recording.mazes: " + mazes.error().text);
  const auto origin =
      config.origin == "person" ? SegmentOrigin::kPerson : SegmentOrigin::kSimulated;
  return SegmentCollector({origin, config.participant, session}, *std::move(mazes));
}

SegmentLog OpenLog(const SegmentOptions& config) {
  auto log = SegmentLog::Open(config.file);
  if (!log) throw StartupError("operator.recording.file: " + log.error().text);
  return *std::move(log);
}

}  // namespace

SegmentTopics::SegmentTopics(bus::Participant& participant, const SegmentOptions& config,
                             const std::map<std::string, std::string>& world_of_robot,
                             const Clock& clock)
    : config_(config),
      session_(SessionName(config)),
      clock_(clock),
      collector_(MakeCollector(config, session_)),
      log_(OpenLog(config)) {
  for (const auto& [robot, world] : world_of_robot) {
    if (truths_.contains(world)) continue;
    truths_[world] = std::make_unique<bus::Subscriber<nav_msgs::msg::OccupancyGrid>>(
        participant, bus::kTruth, world);
  }
}

SegmentTopics::~SegmentTopics() {
  collector_.End();
  Write();
  LOG_INFO("recorded", "file", config_.file, "segments", recorded_, "lost", lost_, "lost_pictures",
           lost_snapshots_);
}

void SegmentTopics::Step() {
  for (const auto& [world, subscriber] : truths_) {
    for (const MapUpdate& truth : subscriber->TakeValid(kToDomain)) {
      collector_.SetTruth(world, truth.cells);
    }
  }
  Write();
}

void SegmentTopics::AddTo(Health& health) const {
  health.values.emplace_back("recorded_segments", std::to_string(recorded_));
  health.values.emplace_back("lost_segments", std::to_string(lost_));
  health.values.emplace_back("lost_pictures", std::to_string(lost_snapshots_));
}

void SegmentTopics::Edited(const Belief& belief) { collector_.Edited(belief, clock_.Now()); }

void SegmentTopics::Guided(const Guidance& guidance) {
  collector_.Guided(guidance, clock_.Now());
  Write();
}

void SegmentTopics::Finish() {
  collector_.Finish(clock_.Now());
  Write();
}

void SegmentTopics::Write() {
  for (RecordedSegment& done : collector_.Take()) {
    const auto written = Append(done);
    ++(written ? recorded_ : lost_);
    if (written) continue;
    if (const auto held_back = failures_logged_.Allow()) {
      LOG_ERROR("segment not recorded", "robot", done.robot, "picture", done.sequence_number,
                "reason", written.error().text, "held_back", *held_back);
    }
  }
}

Result<void> SegmentTopics::Append(RecordedSegment& done) {
  if (config_.pictures && !done.jpeg.empty()) {
    if (const auto kept = KeepSnapshot(done); !kept) NoteLostSnapshot(done, kept.error());
  }
  const auto known = numbers_.find(done.world);
  const std::uint32_t number = known != numbers_.end() ? known->second : log_.trajectories();
  return log_.Append(number, done.trajectory, done.segment).map([&] {
    numbers_.emplace(done.world, number);
  });
}

void SegmentTopics::NoteLostSnapshot(const RecordedSegment& done, const Error& why) {
  ++lost_snapshots_;
  if (const auto held_back = snapshots_logged_.Allow()) {
    LOG_ERROR("picture not kept, its segment is", "robot", done.robot, "picture",
              done.sequence_number, "reason", why.text, "held_back", *held_back);
  }
}

Result<void> SegmentTopics::KeepSnapshot(RecordedSegment& done) const {
  const std::filesystem::path folder = "pictures";
  const std::filesystem::path file =
      folder / fmt::format("{}-{}-{:06}.jpg", session_, done.robot, done.sequence_number);
  const std::filesystem::path data_set = std::filesystem::path(config_.file).parent_path();
  const std::string_view bytes(reinterpret_cast<const char*>(done.jpeg.data()), done.jpeg.size());
  std::error_code ignored;  // WriteFile says what is wrong
  std::filesystem::create_directories(data_set / folder, ignored);
  return WriteFile(data_set / file, bytes).map([&] {
    done.segment.image = file.string();
    done.segment.image_sha256 = Sha256Hex(bytes);
  });
}

}  // namespace conav::operators
