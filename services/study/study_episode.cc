#include "study/study_episode.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/runtime/file.h"
#include "launcher/demo.h"
#include "operator/recording/mcap_file.h"
#include "study/report_page.h"

namespace conav::study {
namespace {

constexpr double kBytesPerMib = 1024.0 * 1024.0;

constexpr Measure kMeasures[] = {
    {"image_mib", "image MiB", "Communication, 180 KiB per picture (MiB)",
     [](const EpisodeMeasures& e) { return e.images * kPaperImageKib / 1024.0; }},
    {"sent_mib", "sent MiB", "Actual bytes of pictures sent (MiB)",
     [](const EpisodeMeasures& e) { return e.image_bytes / kBytesPerMib; }},
    {"h264_mib", "H.264 MiB", "Bytes with the stream as H.264 video (MiB)",
     [](const EpisodeMeasures& e) { return e.h264_bytes / kBytesPerMib; }},
    {"low_level_steps", "steps", "Low-level steps (4 Hz)",
     [](const EpisodeMeasures& e) { return e.low_level_steps; }},
    {"cell_moves", "moves", "Moves from cell to cell",
     [](const EpisodeMeasures& e) { return e.cell_moves; }},
    {"pictures", "pictures", "Pictures sent", [](const EpisodeMeasures& e) { return e.images; }},
    {"guidance", "guidance", "Paths from the operator",
     [](const EpisodeMeasures& e) { return e.guidance; }},
    {"mapping_accuracy_after", "mapping", "Mapping accuracy at the end",
     [](const EpisodeMeasures& e) { return e.mapping_accuracy_after; }, true},
    {"goals_reached_fraction", "goals", "Share of the goals reached",
     [](const EpisodeMeasures& e) {
       return e.goals_total > 0.0 ? e.goals_reached / e.goals_total : 0.0;
     },
     true},
    {"time_s", "time s", "Simulated time (s)", [](const EpisodeMeasures& e) { return e.time_s; }},
    {"human_time_s", "person s", "Time of the person, estimated (s)",
     [](const EpisodeMeasures& e) { return e.human.middle; }},
};

constexpr std::pair<EpisodeStatus, const char*> kStatusNames[] = {
    {EpisodeStatus::kComplete, "complete"},
    {EpisodeStatus::kGoalsLeft, "goals left"},
    {EpisodeStatus::kFailed, "failed"},
};

constexpr std::pair<const char*, double EpisodeMeasures::*> kFields[] = {
    {"pictures", &EpisodeMeasures::images},
    {"picture_bytes", &EpisodeMeasures::image_bytes},
    {"low_level_steps", &EpisodeMeasures::low_level_steps},
    {"cell_moves", &EpisodeMeasures::cell_moves},
    {"guidance", &EpisodeMeasures::guidance},
    {"mapping_accuracy_after", &EpisodeMeasures::mapping_accuracy_after},
    {"goals_reached", &EpisodeMeasures::goals_reached},
    {"goals_total", &EpisodeMeasures::goals_total},
    {"time_s", &EpisodeMeasures::time_s},
};

/// Records of earlier versions have none; they read as 0.
constexpr std::pair<const char*, double EpisodeMeasures::*> kLaterFields[] = {
    {"distance_m", &EpisodeMeasures::distance_m},
    {"optimal_distance_m", &EpisodeMeasures::optimal_distance_m},
    {"decision_ms_p95", &EpisodeMeasures::decision_ms_p95},
    {"h264_bytes", &EpisodeMeasures::h264_bytes},
};

Result<EpisodeStatus> StatusFrom(const std::string& name) {
  const auto found = std::find_if(std::begin(kStatusNames), std::end(kStatusNames),
                                  [&](const auto& entry) { return name == entry.second; });
  if (found != std::end(kStatusNames)) return found->first;
  return Fail(ErrorCode::kMalformed, "status '" + name + "' is not known");
}

EpisodeMeasures MeasuresFrom(const nlohmann::json& json) {
  EpisodeMeasures measures;
  for (const auto& [key, field] : kFields) measures.*field = json.at(key).get<double>();
  for (const auto& [key, field] : kLaterFields) measures.*field = json.value(key, 0.0);
  measures.all_goals_reached = json.at("all_goals_reached").get<bool>();
  return measures;
}

EpisodeRecord RecordOf(const std::string& name, const launcher::DemoResult& result) {
  using launcher::EndReason;
  EpisodeRecord record{
      .name = name, .wall_s = result.outcome.wall_s, .run = result.outcome.run_folder};
  const EndReason reason = result.outcome.reason;
  const auto& restarts = result.outcome.restarts;
  // After a restart the same seed no longer gives the same table.
  if (reason != EndReason::kProcessDied && reason != EndReason::kInterrupted && restarts.empty()) {
    record.measures = MeasuresOf(result.metrics);
    record.status =
        result.all_goals_reached() ? EpisodeStatus::kComplete : EpisodeStatus::kGoalsLeft;
  }
  if (!record.is_complete()) record.detail = launcher::OutcomeLine(result.outcome);
  if (!restarts.empty()) record.detail += "; restarts: " + launcher::RestartsLine(result.outcome);
  return record;
}

constexpr double kStepS = 0.25;

}  // namespace

HumanTime HumanTimeOf(MethodKind method, const EpisodeMeasures& measures,
                      const operators::InteractionTimeParameters& times) {
  if (method == MethodKind::kGreedy) return {};
  if (method == MethodKind::kTeleop) {
    const double keys_s = measures.low_level_steps * kStepS;
    return {keys_s, keys_s, keys_s, 0.0};
  }
  const double answers_s =
      (method == MethodKind::kIgMcts ? measures.images * times.picture_s : 0.0) +
      measures.guidance * times.path_s;
  const double median = std::exp(-0.5 * times.log_sd * times.log_sd);
  const double spread = std::exp(1.6448536269514722 * times.log_sd);
  HumanTime time{answers_s * median / spread, answers_s, answers_s * median * spread, answers_s};
  if (method == MethodKind::kInstruction) {
    time.middle += kGlances * measures.images * times.picture_s;
    time.high += measures.images * kStepS;
  }
  return time;
}

EpisodeMeasures MeasuresOf(const launcher::EpisodeMetrics& metrics) {
  EpisodeMeasures measures;
  for (const launcher::RobotMetrics& robot : metrics.robots) {
    measures.images += static_cast<double>(robot.images);
    measures.image_bytes += static_cast<double>(robot.image_bytes);
    measures.low_level_steps += static_cast<double>(robot.low_level_steps);
    measures.cell_moves += static_cast<double>(robot.cell_moves);
    measures.distance_m += robot.distance_m;
    measures.optimal_distance_m += robot.optimal_distance_m;
    measures.guidance += static_cast<double>(robot.guidance);
    measures.goals_reached += static_cast<double>(robot.goals_reached);
    measures.goals_total += static_cast<double>(robot.goals_total);
    measures.time_s = std::max(measures.time_s, robot.time_s);
    measures.decision_ms_p95 = std::max(measures.decision_ms_p95, robot.decision_ms_p95);
  }
  const auto is_unknown = [](const auto& robot) { return robot.optimal_distance_m == 0.0; };
  if (std::ranges::any_of(metrics.robots, is_unknown)) measures.optimal_distance_m = 0.0;
  measures.mapping_accuracy_after = metrics.after.mapping;
  measures.all_goals_reached = metrics.all_goals_reached;
  return measures;
}

std::span<const Measure> Measures() { return kMeasures; }

std::size_t MeasureIndex(const std::string& key) {
  const auto found = std::find_if(std::begin(kMeasures), std::end(kMeasures),
                                  [&](const Measure& measure) { return key == measure.key; });
  DEMAND(found != std::end(kMeasures), key);
  return static_cast<std::size_t>(found - std::begin(kMeasures));
}

const char* NameOf(EpisodeStatus status) {
  return std::find_if(std::begin(kStatusNames), std::end(kStatusNames),
                      [&](const auto& entry) { return entry.first == status; })
      ->second;
}

nlohmann::ordered_json ToJson(const EpisodeRecord& record) {
  nlohmann::ordered_json json{{"name", record.name},     {"status", NameOf(record.status)},
                              {"detail", record.detail}, {"attempts", record.attempts},
                              {"wall_s", record.wall_s}, {"run", record.run},
                              {"operator", "simulated"}, {"measures", nullptr}};
  if (!record.measures) return json;
  nlohmann::ordered_json measures;
  for (const auto& [key, field] : kFields) measures[key] = (*record.measures).*field;
  for (const auto& [key, field] : kLaterFields) measures[key] = (*record.measures).*field;
  measures["all_goals_reached"] = record.measures->all_goals_reached;
  json["measures"] = std::move(measures);
  return json;
}

Result<void> FromJson(const nlohmann::json& json, EpisodeRecord& record) {
  const auto status = StatusFrom(json.at("status").get<std::string>());
  if (!status) return tl::unexpected(status.error());
  record = {.name = json.at("name").get<std::string>(),
            .status = *status,
            .detail = json.at("detail").get<std::string>(),
            .attempts = json.at("attempts").get<int>(),
            .wall_s = json.at("wall_s").get<double>(),
            .run = json.at("run").get<std::string>()};
  if (!json.at("measures").is_null()) record.measures = MeasuresFrom(json.at("measures"));
  if (record.measures.has_value() != record.has_failed()) return {};
  return Fail(ErrorCode::kMalformed, "status and measures contradict each other");
}

launcher::DemoOptions DemoFor(const launcher::DemoOptions& base, const PlannedEpisode& episode,
                              const std::string& subject, const std::filesystem::path& folder) {
  launcher::DemoOptions options = base;
  options.headless = true;
  options.method = episode.row.method;
  options.search = SearchOf(episode.row, base.search);
  options.communication = episode.row.communication;
  options.teleop_mps = episode.row.teleop_mps;
  options.seed = episode.seed;
  options.maze_seed = episode.maze_seed;
  options.rotation_deg = episode.rotation_deg;
  options.simulated_operator = (folder / PersonPath(subject)).string();
  options.out = folder / "runs" / episode.name;
  return options;
}

Result<double> H264Bytes(const std::filesystem::path& run) {
  auto reader = bag::RecordingOf(run).and_then(
      [](const std::filesystem::path& file) { return bag::McapReader::Open(file); });
  if (!reader) return tl::unexpected(reader.error());
  std::map<std::string, std::string> streams;  // pictures one after the other, by topic
  for (;;) {
    const auto next = reader->Next();
    if (!next) return tl::unexpected(next.error());
    if (!*next) break;
    const std::string& topic = (*next)->topic->channel.topic;
    sensor_msgs::msg::CompressedImage image;
    if (!topic.ends_with("/camera/image/compressed")) continue;
    if (!bus::TypeSupportOf<decltype(image)>().deserialize((*next)->data, &image)) continue;
    streams[topic].append(image.data().begin(), image.data().end());
  }
  double bytes = 0.0;
  const std::filesystem::path pictures = run / "stream.mjpeg";
  const std::filesystem::path video = run / "stream.h264";
  for (const auto& [topic, stream] : streams) {
    if (auto written = WriteFile(pictures, stream); !written) {
      return tl::unexpected(written.error());
    }
    const std::string command = fmt::format(
        "ffmpeg -v error -y -f mjpeg -framerate 4 -i {} -c:v libx264 -f h264 {} </dev/null",
        Quoted(pictures), Quoted(video));
    if (std::system(command.c_str()) != 0) {
      return Fail(ErrorCode::kUnavailable, "ffmpeg failed: " + command);
    }
    bytes += static_cast<double>(std::filesystem::file_size(video));
  }
  std::filesystem::remove(pictures);
  return bytes;
}

EpisodeRecord DemoPlayer::Play(const std::string& name, const launcher::DemoOptions& options) {
  try {
    launcher::Progress silent(stderr, launcher::Progress::Style::kSilent, clock_);
    launcher::Demo demo(options, program_folder_, clock_, silent,
                        std::exchange(lease_, std::nullopt));
    EpisodeRecord record = RecordOf(name, demo.Run(stop_));
    lease_.emplace(demo.TakeLease());
    if (!record.measures || !options.streams) return record;
    const auto encoded = NeedsLiveView(options.method)
                             ? H264Bytes(record.run)
                             : Result<double>(record.measures->image_bytes);
    if (!encoded) return {.name = name, .detail = encoded.error().text, .run = record.run};
    record.measures->h264_bytes = *encoded;
    return record;
  } catch (const std::exception& error) {
    return {.name = name, .detail = error.what()};
  }
}

}  // namespace conav::study
