#include "study/gaze/eye_recording.h"

#include <fmt/core.h>

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
/// Ids of fixations that begin further apart are those of another start of Pupil.
constexpr double kSameFixationS = 60.0;
/// Between two tellings of one mark, whose time each converts from UTC.
constexpr double kSameMarkS = 0.005;

double Finite(const json& value, const char* key) {
  const double number = value.get<double>();
  if (!std::isfinite(number))
    throw json::other_error::create(501, std::string(key) + " is not finite", nullptr);
  return number;
}

double At(const json& message, const char* key) { return Finite(message.at(key), key); }

double Or0(const json& message, const char* key) {
  return message.contains(key) ? At(message, key) : 0.0;
}

GazeSample GazeOf(const json& message) {
  const auto& position = message.at("norm_pos");
  return {At(message, "timestamp"), At(message, "confidence"), Finite(position.at(0), "norm_pos"),
          Finite(position.at(1), "norm_pos")};
}

FixationDatum FixationOf(const std::string& surface, const json& message) {
  const auto& position = message.at("norm_pos");
  return {surface,
          Or0(message, "confidence"),
          {message.at("id").get<std::int64_t>(), At(message, "timestamp"),
           At(message, "duration") / 1000.0, Finite(position.at(0), "norm_pos"),
           Finite(position.at(1), "norm_pos")}};
}

PupilDatum PupilOf(const json& message) {
  PupilDatum pupil{.time_s = At(message, "timestamp"),
                   .eye = message.at("id").get<int>(),
                   .method = message.value("method", std::string()),
                   .confidence = At(message, "confidence"),
                   .diameter_px = Or0(message, "diameter")};
  if (message.contains("norm_pos")) {
    pupil.x = Finite(message["norm_pos"].at(0), "norm_pos");
    pupil.y = Finite(message["norm_pos"].at(1), "norm_pos");
  }
  if (message.contains("diameter_3d")) pupil.diameter_mm = At(message, "diameter_3d");
  if (!pupil.diameter_mm) pupil.diameter_px = At(message, "diameter");
  return pupil;
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

std::vector<EyeDatum> SurfaceData(const json& message) {
  const auto name = message.at("name").get<std::string>();
  std::vector<EyeDatum> data;
  for (const json& gaze : message.value("gaze_on_surfaces", json::array())) {
    data.emplace_back(GazeDatum{name, GazeOf(gaze)});
  }
  for (const json& fixation : message.value("fixations_on_surfaces", json::array())) {
    data.emplace_back(FixationOf(name, fixation));
  }
  return data;
}

/// Accepts what is nested no deeper than the limit: the parser is recursive.
class DepthCheck : public nlohmann::json_sax<json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(json::number_integer_t) override { return true; }
  bool number_unsigned(json::number_unsigned_t) override { return true; }
  bool number_float(json::number_float_t, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(json::binary_t&) override { return true; }
  bool key(std::string&) override { return true; }
  bool start_object(std::size_t) override { return ++depth_ <= kMessageDepth; }
  bool start_array(std::size_t) override { return ++depth_ <= kMessageDepth; }
  bool end_object() override { return Leave(); }
  bool end_array() override { return Leave(); }
  bool parse_error(std::size_t, const std::string&, const json::exception&) override {
    return false;
  }

 private:
  bool Leave() {
    --depth_;
    return true;
  }

  int depth_ = 0;
};

/// A surface has what is on it.
bool IsOn(double x, double y) { return x >= 0.0 && x <= 1.0 && y >= 0.0 && y <= 1.0; }

void DropRepeated(std::vector<Mark>& marks) {
  std::vector<Mark> kept;
  for (Mark& mark : marks) {
    const auto is_same = [&](const Mark& old) {
      return mark.time_s - old.time_s <= kSameMarkS && old.label == mark.label &&
             old.keys == mark.keys;
    };
    if (std::ranges::none_of(kept, is_same)) kept.push_back(std::move(mark));
  }
  marks = std::move(kept);
}

template <class T>
void SortByTime(std::vector<T>& values) {
  std::ranges::stable_sort(values, {}, &T::time_s);
}

}  // namespace

Result<json> ParseMessage(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kMessageLimit) {
    return Fail(ErrorCode::kMalformed, fmt::format("a message of {} bytes is larger than {}",
                                                   bytes.size(), kMessageLimit));
  }
  DepthCheck check;
  json message;
  if (json::sax_parse(bytes.begin(), bytes.end(), &check, json::input_format_t::msgpack)) {
    message = json::from_msgpack(bytes.begin(), bytes.end(), true, false);
  }
  if (message.is_object()) return message;
  return Fail(ErrorCode::kMalformed,
              fmt::format("a message of {} bytes is no MessagePack map", bytes.size()));
}

Result<std::vector<EyeDatum>> DecodeMessage(const std::string& topic, const json& message) {
  const std::string kind = topic.substr(0, topic.find('.'));
  std::vector<EyeDatum> data;
  try {
    if (kind == "pupil") {
      data.emplace_back(PupilOf(message));
    } else if (kind == "gaze") {
      data.emplace_back(GazeDatum{"", GazeOf(message)});
    } else if (kind == "fixations" || kind == "fixation") {
      data.emplace_back(FixationOf("", message));
    } else if (kind == "blinks" || kind == "blink") {
      const bool onset = message.at("type").get<std::string>() == "onset";
      data.emplace_back(BlinkDatum{At(message, "timestamp"), onset, Or0(message, "confidence")});
    } else if (kind == "surfaces") {
      data = SurfaceData(message);
    } else if (kind == "annotation") {
      data.emplace_back(MarkOf(message));
    }
  } catch (const json::exception& error) {
    return Fail(ErrorCode::kMalformed, fmt::format("message of topic {}: {}", topic, error.what()));
  }
  return data;
}

Result<void> EyeCollector::Add(const std::string& topic, const json& message) {
  const auto data = DecodeMessage(topic, message);
  if (!data) return tl::unexpected(data.error());
  for (const EyeDatum& datum : *data) Add(datum);
  return {};
}

void EyeCollector::Add(const EyeDatum& datum) {
  if (const auto* pupil = std::get_if<PupilDatum>(&datum)) {
    AddPupil({pupil->time_s, pupil->eye, pupil->confidence,
              pupil->diameter_mm.value_or(pupil->diameter_px)},
             pupil->diameter_mm.has_value());
  } else if (const auto* gaze = std::get_if<GazeDatum>(&datum)) {
    if (gaze->surface.empty()) {
      recording_.gaze.push_back(gaze->sample);
      return;
    }
    SurfaceGaze& surface = recording_.surfaces[gaze->surface];
    if (IsOn(gaze->sample.x, gaze->sample.y)) surface.gaze.push_back(gaze->sample);
  } else if (const auto* found = std::get_if<FixationDatum>(&datum)) {
    if (found->surface.empty()) return AddFixation(recording_.fixations, found->fixation);
    SurfaceGaze& surface = recording_.surfaces[found->surface];
    const Fixation& fixation = found->fixation;
    if (IsOn(fixation.x, fixation.y)) AddFixation(surface.fixations, fixation);
  } else if (const auto* blink = std::get_if<BlinkDatum>(&datum)) {
    AddBlink(blink->time_s, blink->onset);
  } else {
    recording_.marks.push_back(std::get<Mark>(datum));
  }
}

void EyeCollector::AddPupil(const PupilSample& sample, bool is_3d) {
  if (is_3d && !recording_.in_mm) recording_.pupils.clear();
  recording_.in_mm = recording_.in_mm || is_3d;
  if (is_3d == recording_.in_mm) recording_.pupils.push_back(sample);
}

void EyeCollector::AddFixation(std::vector<Fixation>& fixations, const Fixation& fixation) {
  const auto known = std::find_if(fixations.rbegin(), fixations.rend(), [&](const Fixation& old) {
    return old.id == fixation.id && std::abs(old.begin_s - fixation.begin_s) <= kSameFixationS;
  });
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

EyeRecording EyeCollector::Finish() && {
  CloseBlink();
  SortByTime(recording_.pupils);
  SortByTime(recording_.gaze);
  SortByTime(recording_.marks);
  DropRepeated(recording_.marks);
  std::ranges::stable_sort(recording_.fixations, {}, &Fixation::begin_s);
  std::ranges::stable_sort(recording_.blinks, {}, &Blink::begin_s);
  for (auto& [name, surface] : recording_.surfaces) {
    SortByTime(surface.gaze);
    std::ranges::stable_sort(surface.fixations, {}, &Fixation::begin_s);
  }
  return std::move(recording_);
}

}  // namespace conav::gaze
