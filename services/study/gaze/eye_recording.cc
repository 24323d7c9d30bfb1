#include "study/gaze/eye_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

namespace conav::gaze {
namespace {

using nlohmann::json;

/// An onset that comes later than this after the last one begins another blink: the offset between
/// them was lost.
constexpr double kSameBlinkS = 0.5;

double At(const json& message, const char* key) {
  const double value = message.at(key).get<double>();
  if (!std::isfinite(value))
    throw json::other_error::create(501, std::string(key) + " is not finite", nullptr);
  return value;
}

GazeSample GazeOf(const json& message) {
  const auto& position = message.at("norm_pos");
  return {At(message, "timestamp"), At(message, "confidence"), position.at(0).get<double>(),
          position.at(1).get<double>()};
}

Fixation FixationOf(const json& message) {
  const auto& position = message.at("norm_pos");
  return {message.at("id").get<std::int64_t>(), At(message, "timestamp"),
          At(message, "duration") / 1000.0, position.at(0).get<double>(),
          position.at(1).get<double>()};
}

std::string TextOf(const json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

Mark MarkOf(const json& message) {
  Mark mark{At(message, "timestamp"), message.at("label").get<std::string>(), {}};
  static constexpr std::array kOwn{"timestamp", "label", "topic", "duration"};
  for (const auto& [key, value] : message.items()) {
    if (std::ranges::find(kOwn, key) == kOwn.end()) mark.keys[key] = TextOf(value);
  }
  return mark;
}

template <class T>
void SortByTime(std::vector<T>& values) {
  std::ranges::stable_sort(values, {}, &T::time_s);
}

}  // namespace

Result<void> EyeCollector::Add(const std::string& topic, const json& message) {
  const std::string kind = topic.substr(0, topic.find('.'));
  try {
    if (kind == "pupil") {
      const bool is_3d = message.contains("diameter_3d");
      AddPupil({At(message, "timestamp"), message.at("id").get<int>(), At(message, "confidence"),
                At(message, is_3d ? "diameter_3d" : "diameter")},
               is_3d);
    } else if (kind == "gaze") {
      recording_.gaze.push_back(GazeOf(message));
    } else if (kind == "fixations" || kind == "fixation") {
      AddFixation(recording_.fixations, FixationOf(message));
    } else if (kind == "blinks" || kind == "blink") {
      AddBlink(At(message, "timestamp"), message.at("type").get<std::string>() == "onset");
    } else if (kind == "surfaces") {
      AddSurface(message.at("name").get<std::string>(), message);
    } else if (kind == "annotation") {
      recording_.marks.push_back(MarkOf(message));
    }
  } catch (const json::exception& error) {
    return Fail(ErrorCode::kMalformed, fmt::format("message of topic {}: {}", topic, error.what()));
  }
  return {};
}

void EyeCollector::AddPupil(const PupilSample& sample, bool is_3d) {
  if (is_3d && !recording_.in_mm) recording_.pupils.clear();
  recording_.in_mm = recording_.in_mm || is_3d;
  if (is_3d == recording_.in_mm) recording_.pupils.push_back(sample);
}

void EyeCollector::AddFixation(std::vector<Fixation>& fixations, const Fixation& fixation) {
  const auto known = std::find_if(fixations.rbegin(), fixations.rend(),
                                  [&](const Fixation& old) { return old.id == fixation.id; });
  if (known == fixations.rend()) {
    fixations.push_back(fixation);
  } else {
    *known = fixation;
  }
}

void EyeCollector::AddBlink(double time_s, bool is_onset) {
  const bool continues = blink_ && time_s - blink_->end_s <= kSameBlinkS;
  if (is_onset && (!continues || has_offset_)) {
    CloseBlink();
    blink_ = Blink{time_s, time_s};
  } else if (continues) {
    blink_->end_s = time_s;
    has_offset_ = has_offset_ || !is_onset;
  }
}

void EyeCollector::CloseBlink() {
  if (blink_ && has_offset_) recording_.blinks.push_back(*blink_);
  blink_.reset();
  has_offset_ = false;
}

void EyeCollector::AddSurface(const std::string& name, const json& message) {
  SurfaceGaze& surface = recording_.surfaces[name];
  for (const json& gaze : message.value("gaze_on_surfaces", json::array())) {
    if (gaze.at("on_surf").get<bool>()) surface.gaze.push_back(GazeOf(gaze));
  }
  for (const json& fixation : message.value("fixations_on_surfaces", json::array())) {
    if (fixation.at("on_surf").get<bool>()) AddFixation(surface.fixations, FixationOf(fixation));
  }
}

EyeRecording EyeCollector::Finish() && {
  CloseBlink();
  SortByTime(recording_.pupils);
  SortByTime(recording_.gaze);
  SortByTime(recording_.marks);
  std::ranges::stable_sort(recording_.fixations, {}, &Fixation::begin_s);
  std::ranges::stable_sort(recording_.blinks, {}, &Blink::begin_s);
  for (auto& [name, surface] : recording_.surfaces) {
    SortByTime(surface.gaze);
    std::ranges::stable_sort(surface.fixations, {}, &Fixation::begin_s);
  }
  return std::move(recording_);
}

}  // namespace conav::gaze
