#include "study/gaze/eye_tracker_service.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/bus/topics.h"
#include "common/runtime/config.h"
#include "common/runtime/text.h"

namespace conav::gaze {
namespace {

/// Marks of a step that began a little before this program are its own.
constexpr double kMarksBeforeS = 10.0;
constexpr std::chrono::milliseconds kStepLimit{20};
constexpr std::size_t kTextLimit = 200;

std::string Short(const std::string& text) { return Readable(text.substr(0, kTextLimit)); }

/// A message with the times that all of them have.
template <class Message>
Message Timed(double pupil_s, const TrackerClock& clock) {
  Message message;
  const double utc_s = clock.ToUtc(pupil_s);
  message.header().stamp(RosWallTime(Seconds(utc_s)));
  message.utc(utc_s);
  message.pupil_time(pupil_s);
  return message;
}

conav_msgs::msg::EyePupil ToMessage(const PupilDatum& pupil, const TrackerClock& clock) {
  auto message = Timed<conav_msgs::msg::EyePupil>(pupil.time_s, clock);
  message.eye(pupil.eye == 0 ? 0 : 1);
  message.method(Short(pupil.method));
  message.confidence(static_cast<float>(pupil.confidence));
  message.x(static_cast<float>(pupil.x));
  message.y(static_cast<float>(pupil.y));
  message.diameter(static_cast<float>(pupil.diameter_px));
  message.diameter_3d(pupil.diameter_mm ? static_cast<float>(*pupil.diameter_mm)
                                        : std::numeric_limits<float>::quiet_NaN());
  return message;
}

conav_msgs::msg::EyeGaze ToMessage(const GazeDatum& gaze, const TrackerClock& clock) {
  auto message = Timed<conav_msgs::msg::EyeGaze>(gaze.sample.time_s, clock);
  message.surface(Short(gaze.surface));
  message.confidence(static_cast<float>(gaze.sample.confidence));
  message.x(static_cast<float>(gaze.sample.x));
  message.y(static_cast<float>(gaze.sample.y));
  return message;
}

conav_msgs::msg::EyeFixation ToMessage(const FixationDatum& datum, const TrackerClock& clock) {
  const Fixation& fixation = datum.fixation;
  auto message = Timed<conav_msgs::msg::EyeFixation>(fixation.begin_s, clock);
  message.id(fixation.id);
  message.surface(Short(datum.surface));
  message.duration(fixation.duration_s);
  message.confidence(static_cast<float>(datum.confidence));
  message.x(static_cast<float>(fixation.x));
  message.y(static_cast<float>(fixation.y));
  return message;
}

conav_msgs::msg::EyeBlink ToMessage(const BlinkDatum& blink, const TrackerClock& clock) {
  auto message = Timed<conav_msgs::msg::EyeBlink>(blink.time_s, clock);
  message.onset(blink.onset);
  message.confidence(static_cast<float>(blink.confidence));
  return message;
}

}  // namespace

void EyeTrackerConfig::Visit(ConfigReader& reader) {
  reader.Section("bus", bus);
  reader.Field("address", address);
  const auto colon = address.rfind(':');
  const bool names_port = address.starts_with("tcp://") && colon != std::string::npos &&
                          colon > 6 && colon + 1 < address.size();
  if (!names_port) reader.Refuse("address", "is not tcp://HOST:PORT");
  reader.Field("record", record);
  reader.Field("recording_name", recording_name);
  if (!recording_name.empty() && !IsPlainName(recording_name)) {
    reader.Refuse("recording_name", kNoPlainName);
  }
}

EyeTrackerService::EyeTrackerService(bus::Participant& participant, const EyeTrackerConfig& config,
                                     const Clock& clock)
    : participant_(participant),
      clock_(clock),
      config_(config),
      started_s_(WallSeconds()),
      pupils_(participant, bus::kEyePupil),
      gaze_(participant, bus::kEyeGaze),
      fixations_(participant, bus::kEyeFixation),
      blinks_(participant, bus::kEyeBlink),
      clocks_(participant, bus::kEyeClock),
      marks_(participant, bus::kStudyMark),
      events_(participant, bus::kOperatorEvent),
      malformed_logged_(std::chrono::seconds(10)),
      diagnostics_(participant, clock) {}

void EyeTrackerService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) Step(kStepLimit);
  if (!remote_) return;
  SendAnnotations();
  if (config_.record) {
    if (const auto ended = remote_->Ask("r"); !ended) {
      LOG_WARNING("recording of Pupil Capture not ended", "reason", ended.error().text);
    }
  }
}

void EyeTrackerService::Step(std::chrono::milliseconds limit) {
  TakeMarks();
  if (!remote_ && clock_.Now() >= connect_at_) Connect();
  if (remote_ && clock_.Now() >= probe_at_) Probe();
  if (remote_) {
    SendAnnotations();
    constexpr int kMostAtOnce = 500;  // then health and marks have their turn
    auto message = remote_->Receive(limit);
    for (int i = 1; message; ++i) {
      Take(*message);
      if (i == kMostAtOnce) break;
      message = remote_->Receive(std::chrono::milliseconds(0));
    }
  } else {
    participant_.Wait(limit);
  }
  diagnostics_.Tick([this] { return Report(); });
}

void EyeTrackerService::Connect() {
  auto remote = PupilRemote::Connect(config_.address);
  connect_at_ = clock_.Now() + kRetryPeriod;
  if (!remote) {
    if (problem_ != remote.error().text) {
      LOG_WARNING("no eye tracker", "reason", remote.error().text);
    }
    problem_ = remote.error().text;
    return;
  }
  remote_.emplace(*std::move(remote));
  probe_at_ = clock_.Now() + kProbePeriod;
  newest_ = clock_.Now();
  LOG_INFO("eye tracker connected", "address", config_.address, "version", remote_->version(),
           "round_trip_s", remote_->clock().round_trip_s);
  PublishClock();
  if (!config_.record) return;
  const std::string& name = config_.recording_name;
  const auto begun = remote_->Ask(name.empty() ? "R" : "R " + name);
  if (!begun) Disconnect(begun.error());
}

void EyeTrackerService::Disconnect(const Error& reason) {
  LOG_WARNING("eye tracker lost", "reason", reason.text);
  problem_ = reason.text;
  remote_.reset();
  connect_at_ = clock_.Now();
  ++counts_["connections_lost"];
}

void EyeTrackerService::Probe() {
  const auto alive = remote_->CheckAlive();
  if (!alive) return Disconnect(alive.error());
  probe_at_ = clock_.Now() + kProbePeriod;
  PublishClock();
}

void EyeTrackerService::PublishClock() {
  const TrackerClock& now = remote_->clock();
  auto message = Timed<conav_msgs::msg::EyeClock>(now.pupil_s, now);
  message.round_trip(now.round_trip_s);
  message.drift(now.drift);
  bus::Send(clocks_, message);
}

void EyeTrackerService::Take(const PupilMessage& message) {
  newest_ = clock_.Now();
  const auto data = ParseMessage(message.payload).and_then([&](const nlohmann::json& parsed) {
    return DecodeMessage(message.topic, parsed);
  });
  if (data) {
    if (!data->empty()) ++counts_[message.topic.substr(0, message.topic.find('.'))];
    for (const EyeDatum& datum : *data) Publish(datum);
    return;
  }
  ++counts_["malformed"];
  if (const auto held_back = malformed_logged_.Allow()) {
    LOG_WARNING("message of the eye tracker refused", "topic", Short(message.topic), "reason",
                Readable(data.error().text), "held_back", *held_back);
  }
}

void EyeTrackerService::Publish(const EyeDatum& datum) {
  const TrackerClock& now = remote_->clock();
  if (const auto* pupil = std::get_if<PupilDatum>(&datum)) {
    bus::Send(pupils_, ToMessage(*pupil, now));
  } else if (const auto* gaze = std::get_if<GazeDatum>(&datum)) {
    bus::Send(gaze_, ToMessage(*gaze, now));
  } else if (const auto* fixation = std::get_if<FixationDatum>(&datum)) {
    bus::Send(fixations_, ToMessage(*fixation, now));
  } else if (const auto* blink = std::get_if<BlinkDatum>(&datum)) {
    bus::Send(blinks_, ToMessage(*blink, now));
  }
}

void EyeTrackerService::TakeMarks() {
  for (const auto& mark : marks_.Take()) {
    Annotation annotation{mark.utc(), mark.label(), {}};
    const std::size_t keys = std::min(mark.keys().size(), mark.values().size());
    for (std::size_t i = 0; i < keys; ++i) annotation.keys[mark.keys()[i]] = mark.values()[i];
    Queue(std::move(annotation));
  }
  for (const auto& [event, source, writer] : events_.TakeStamped()) {
    Queue({ToWallSeconds(source),
           "operator event",
           {{"text", event.text()},
            {"client", event.client()},
            {"robot", event.robot()},
            {"accepted", event.accepted() ? "true" : "false"}}});
  }
}

void EyeTrackerService::Queue(Annotation annotation) {
  if (!(annotation.utc_s >= started_s_ - kMarksBeforeS)) return;
  if (waiting_.size() >= kWaitingLimit) {
    waiting_.pop_front();
    ++counts_["annotations_dropped"];
  }
  waiting_.push_back(std::move(annotation));
}

void EyeTrackerService::SendAnnotations() {
  if (!remote_->MayAnnotate()) return;
  for (; !waiting_.empty(); waiting_.pop_front()) {
    const Annotation& next = waiting_.front();
    remote_->Annotate(next.label, remote_->clock().ToPupil(next.utc_s), next.keys);
    ++counts_["annotations"];
  }
}

Health EyeTrackerService::Report() const {
  Health health;
  const bool quiet = clock_.Now() - newest_ > kQuietLimit;
  if (!remote_) {
    health.message = "no eye tracker: " + problem_;
  } else if (quiet) {
    health.message = "the eye tracker sends nothing: are its eye windows open?";
  } else {
    health.message = "receiving";
  }
  if (!remote_ || quiet) health.level = Health::Level::kWarning;
  health.values = {{"address", config_.address},
                   {"subscribers", std::to_string(pupils_.matched_subscribers())},
                   {"waiting", std::to_string(waiting_.size())}};
  if (remote_) {
    health.values.emplace_back("version", remote_->version());
    health.values.emplace_back("round_trip_s",
                               fmt::format("{:.6f}", remote_->clock().round_trip_s));
    health.values.emplace_back("drift", fmt::format("{:.3e}", remote_->clock().drift));
  }
  for (const auto& [name, count] : counts_) health.values.emplace_back(name, std::to_string(count));
  return health;
}

}  // namespace conav::gaze
