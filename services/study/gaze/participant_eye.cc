#include "study/gaze/participant_eye.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "common/bus/topics.h"
#include "common/bus/type_support.h"
#include "common/runtime/file.h"
#include "operator/recording/mcap_file.h"

namespace conav::gaze {
namespace {

namespace fs = std::filesystem;

constexpr double kDayS = 24.0 * 3600.0;  // more is a broken time
/// Clocks one after the other differ by more only if one was set; clocks drift by less than kMostDrift.
constexpr double kSetS = 0.005;
constexpr double kMostDrift = 5e-4;

/// One start of the tracker: its clock, from probe to probe.
struct Session {
  struct Clock {
    double utc_s = 0.0;
    double offset_s = 0.0;  // the tracker's time minus UTC
  };
  std::vector<Clock> clocks;  // by time, at least one

  double first_offset() const { return clocks.front().offset_s; }
  double OffsetAt(double utc_s) const {
    const auto after = std::ranges::upper_bound(clocks, utc_s, {}, &Clock::utc_s);
    if (after == clocks.begin()) return clocks.front().offset_s;
    if (after == clocks.end()) return clocks.back().offset_s;
    const auto before = std::prev(after);
    const double share = (utc_s - before->utc_s) / (after->utc_s - before->utc_s);
    return before->offset_s + share * (after->offset_s - before->offset_s);
  }
  /// How far `utc_s` is from its clocks.
  double DistanceTo(double utc_s) const {
    return std::max({clocks.front().utc_s - utc_s, utc_s - clocks.back().utc_s, 0.0});
  }
};

struct RecordedDatum {
  double offset_s = 0.0;
  EyeDatum datum;
};

/// What the recordings of one folder have. Times of data are the tracker's, others are UTC.
struct Recorded {
  std::vector<std::pair<Session::Clock, double>> clocks;  // with their round trips
  std::vector<RecordedDatum> data;
  std::vector<Mark> marks;
  std::vector<conav_msgs::msg::PageLayout> layouts;
  std::map<std::string, std::pair<int, int>> maps;  // rows and columns, by world
};

EyeDatum DatumOf(const conav_msgs::msg::EyePupil& pupil) {
  PupilDatum datum{.time_s = pupil.pupil_time(),
                   .eye = pupil.eye(),
                   .confidence = pupil.confidence(),
                   .x = pupil.x(),
                   .y = pupil.y(),
                   .diameter_px = pupil.diameter()};
  if (std::isfinite(pupil.diameter_3d())) datum.diameter_mm = pupil.diameter_3d();
  return datum;
}

EyeDatum DatumOf(const conav_msgs::msg::EyeGaze& gaze) {
  return GazeDatum{gaze.surface(), {gaze.pupil_time(), gaze.confidence(), gaze.x(), gaze.y()}};
}

EyeDatum DatumOf(const conav_msgs::msg::EyeFixation& message) {
  return FixationDatum{
      message.surface(),
      message.confidence(),
      {message.id(), message.pupil_time(), message.duration(), message.x(), message.y()}};
}

EyeDatum DatumOf(const conav_msgs::msg::EyeBlink& blink) {
  return BlinkDatum{blink.pupil_time(), blink.onset(), blink.confidence()};
}

Mark MarkOf(const conav_msgs::msg::StudyMark& message) {
  Mark mark{message.utc(), message.label(), {}};
  const std::size_t keys = std::min(message.keys().size(), message.values().size());
  for (std::size_t i = 0; i < keys; ++i) mark.keys[message.keys()[i]] = message.values()[i];
  return mark;
}

/// Takes up a serialised message; false when it is not of its type, or its times are no numbers.
using TakeUp = std::function<bool(std::span<const std::uint8_t>)>;

template <class T, class Use>
TakeUp Taking(Use use) {
  return [use](std::span<const std::uint8_t> data) {
    T message;
    return bus::TypeSupportOf<T>().deserialize(data, &message) && use(message);
  };
}

template <class T>
TakeUp TakingData(const bus::Topic<T>&, Recorded& recorded) {
  return Taking<T>([&recorded](const T& message) {
    const double offset = message.pupil_time() - message.utc();
    if (!std::isfinite(offset)) return false;
    recorded.data.push_back({offset, DatumOf(message)});
    return true;
  });
}

std::map<std::string, TakeUp> Topics(Recorded& recorded) {
  std::map<std::string, TakeUp> topics;
  const auto add_data = [&](const auto& topic) {
    topics[topic.NameFor("")] = TakingData(topic, recorded);
  };
  add_data(bus::kEyePupil);
  add_data(bus::kEyeGaze);
  add_data(bus::kEyeFixation);
  add_data(bus::kEyeBlink);
  topics[bus::kEyeClock.NameFor("")] =
      Taking<conav_msgs::msg::EyeClock>([&recorded](const auto& clock) {
        const double offset = clock.pupil_time() - clock.utc();
        if (std::isfinite(offset)) {
          recorded.clocks.push_back({{clock.utc(), offset}, clock.round_trip()});
        }
        return std::isfinite(offset);
      });
  topics[bus::kStudyMark.NameFor("")] =
      Taking<conav_msgs::msg::StudyMark>([&recorded](const auto& mark) {
        if (std::isfinite(mark.utc())) recorded.marks.push_back(MarkOf(mark));
        return std::isfinite(mark.utc());
      });
  topics[bus::kPageLayout.NameFor("")] =
      Taking<conav_msgs::msg::PageLayout>([&recorded](const auto& layout) {
        if (std::isfinite(layout.utc())) recorded.layouts.push_back(layout);
        return std::isfinite(layout.utc());
      });
  return topics;
}

/// "/w1/initial_map" -> "w1"; empty for other topics.
std::string WorldOf(const std::string& topic) {
  static const std::string end_of_name = bus::kInitialMap.NameFor("").substr(1);  // "/initial_map"
  const bool is_map = topic.ends_with(end_of_name) && topic.size() > end_of_name.size() + 1;
  return is_map ? topic.substr(1, topic.size() - 1 - end_of_name.size()) : "";
}

Result<void> ReadFolder(const fs::path& folder, Recorded& recorded) {
  auto first = bag::RecordingOf(folder);
  if (!first) return tl::unexpected(first.error());
  auto reader = bag::McapReader::Open(*first);
  if (!reader) return tl::unexpected(reader.error());
  std::map<std::string, TakeUp> topics = Topics(recorded);
  for (const bag::RecordedTopic& topic : reader->topics()) {
    const std::string world = WorldOf(topic.channel.topic);
    if (world.empty()) continue;
    topics[topic.channel.topic] =
        Taking<nav_msgs::msg::OccupancyGrid>([&recorded, world](const auto& map) {
          recorded.maps[world] = {static_cast<int>(map.info().height()),
                                  static_cast<int>(map.info().width())};
          return true;
        });
  }
  while (true) {
    auto next = reader->Next();
    if (!next) return tl::unexpected(next.error());
    if (!*next) return {};
    const std::string& topic = (*next)->topic->channel.topic;
    const auto take_up = topics.find(topic);
    if (take_up == topics.end() || take_up->second((*next)->data)) continue;
    return Fail(ErrorCode::kMalformed, fmt::format("{}: a message of {} is not what it should be",
                                                   first->string(), topic));
  }
}

/// By time, one after the other.
std::vector<Session> SessionsOf(Recorded& recorded) {
  std::ranges::sort(recorded.clocks, {}, [](const auto& clock) { return clock.first.utc_s; });
  std::vector<Session> sessions;
  double last_round_trip = 0.0;
  for (const auto& [clock, round_trip] : recorded.clocks) {
    if (!sessions.empty()) {
      const Session::Clock& last = sessions.back().clocks.back();
      if (clock.utc_s == last.utc_s) continue;  // a recorder that was restarted gets it again
      const double limit =
          kSetS + (round_trip + last_round_trip) / 2.0 + kMostDrift * (clock.utc_s - last.utc_s);
      if (std::abs(clock.offset_s - last.offset_s) > limit) sessions.emplace_back();
    } else {
      sessions.emplace_back();
    }
    sessions.back().clocks.push_back(clock);
    last_round_trip = round_trip;
  }
  if (sessions.empty() && !recorded.data.empty()) {
    sessions.push_back({{{0.0, recorded.data.front().offset_s}}});
  }
  return sessions;
}

/// Where a page's pixels are on its surface: the outer corners of its tags.
struct Surface {
  explicit Surface(const conav_msgs::msg::PageLayout& layout) {
    if (layout.tags().empty()) {
      width = layout.width();
      height = layout.height();
      return;
    }
    double right = -1e9;
    double bottom = -1e9;
    left = top = 1e9;
    for (const auto& tag : layout.tags()) {
      left = std::min(left, tag.x());
      top = std::min(top, tag.y());
      right = std::max(right, tag.x() + tag.width());
      bottom = std::max(bottom, tag.y() + tag.height());
    }
    width = right - left;
    height = bottom - top;
  }

  double left = 0.0;
  double top = 0.0;
  double width = 0.0;
  double height = 0.0;
};

std::optional<AreaLayout> LayoutOf(const conav_msgs::msg::PageLayout& layout, double time_s,
                                   const std::map<std::string, std::pair<int, int>>& maps) {
  const Surface surface(layout);
  if (!(surface.width > 0.0) || !(surface.height > 0.0)) return std::nullopt;
  AreaLayout result{.time_s = time_s};
  for (const auto& area : layout.areas()) {
    result.areas.push_back({area.name(), (area.x() - surface.left) / surface.width,
                            (area.y() - surface.top) / surface.height, area.width() / surface.width,
                            area.height() / surface.height});
  }
  const auto size = maps.find(layout.world());
  if (size != maps.end() && layout.map_dx() > 0.0 && layout.map_dy() > 0.0) {
    result.map = MapOnPage{.x = (layout.map_x() - surface.left) / surface.width,
                           .y = (layout.map_y() - surface.top) / surface.height,
                           .dx = layout.map_dx() / surface.width,
                           .dy = layout.map_dy() / surface.height,
                           .rows = size->second.first,
                           .columns = size->second.second};
  }
  return result;
}

double& TimeOf(EyeDatum& datum) {
  if (auto* pupil = std::get_if<PupilDatum>(&datum)) return pupil->time_s;
  if (auto* gaze = std::get_if<GazeDatum>(&datum)) return gaze->sample.time_s;
  if (auto* fixation = std::get_if<FixationDatum>(&datum)) return fixation->fixation.begin_s;
  if (auto* blink = std::get_if<BlinkDatum>(&datum)) return blink->time_s;
  return std::get<Mark>(datum).time_s;
}

/// What participant.json says of each step.
std::map<std::string, std::map<std::string, std::string>> StepKeys(const fs::path& folder) {
  const auto text = ReadFile(folder / "participant.json");
  std::map<std::string, std::map<std::string, std::string>> keys;
  if (!text) return keys;
  const auto design = nlohmann::json::parse(*text, nullptr, false);
  if (!design.is_object() || !design.contains("parts") || !design["parts"].is_array()) return keys;
  for (const auto& part : design["parts"]) {
    if (!part.is_object() || !part.contains("step") || !part["step"].is_string()) continue;
    auto& of_step = keys[part["step"].get<std::string>()];
    for (const auto& [key, value] : part.items()) {
      if (value.is_primitive())
        of_step[key] = value.is_string() ? value.get<std::string>() : value.dump();
    }
  }
  return keys;
}

/// Folders with a recording: this one, or those in it.
std::vector<fs::path> RecordedFolders(const fs::path& folder) {
  const auto has = [](const fs::path& path) {
    return !bag::FilesLike(path / "recording.mcap").empty();
  };
  if (has(folder)) return {folder};
  std::vector<fs::path> folders;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.is_directory(none) && has(entry.path())) folders.push_back(entry.path());
  }
  std::ranges::sort(folders);
  return folders;
}

/// Joins what the folders have on one clock: the first session's.
class Timeline {
 public:
  void Add(Recorded recorded) {
    const std::vector<Session> sessions = SessionsOf(recorded);
    if (!clock_offset_ && !sessions.empty()) clock_offset_ = sessions.front().first_offset();
    for (RecordedDatum& datum : recorded.data) {
      const auto session = std::ranges::min_element(sessions, {}, [&](const Session& one) {
        return std::abs(one.OffsetAt(TimeOf(datum.datum) - datum.offset_s) - datum.offset_s);
      });
      TimeOf(datum.datum) += *clock_offset_ - session->first_offset();
      collector_.Add(datum.datum);
    }
    // UTC until Finish(): the tracker may come later than the first mark.
    const auto add_utc = [&](double utc_s) {
      const auto session = std::ranges::min_element(
          sessions, {}, [&](const Session& one) { return one.DistanceTo(utc_s); });
      if (session == sessions.end()) return utc_s;
      return utc_s + session->OffsetAt(utc_s) - session->first_offset();
    };
    for (Mark& mark : recorded.marks) {
      mark.time_s = add_utc(mark.time_s);
      marks_.push_back(std::move(mark));
    }
    for (const auto& layout : recorded.layouts) {
      if (auto made = LayoutOf(layout, add_utc(layout.utc()), recorded.maps)) {
        layouts_.push_back(*std::move(made));
      }
    }
  }

  ParticipantEyes Finish(const std::string& page) && {
    const double offset = clock_offset_.value_or(0.0);
    for (Mark& mark : marks_) {
      mark.time_s += offset;
      collector_.Add(std::move(mark));
    }
    for (AreaLayout& layout : layouts_) layout.time_s += offset;
    std::ranges::stable_sort(layouts_, {}, &AreaLayout::time_s);
    ParticipantEyes eyes{std::move(collector_).Finish(), {page, std::move(layouts_)}};
    eyes.recording.utc_offset_s = -offset;
    return eyes;
  }

 private:
  EyeCollector collector_;
  std::optional<double> clock_offset_;
  std::vector<Mark> marks_;
  std::vector<AreaLayout> layouts_;
};

}  // namespace

bool HasBusRecordings(const fs::path& folder) { return !RecordedFolders(folder).empty(); }

Result<ParticipantEyes> ReadParticipantEyes(const fs::path& folder, const std::string& page) {
  Timeline timeline;
  for (const fs::path& step : RecordedFolders(folder)) {
    Recorded recorded;
    if (auto read = ReadFolder(step, recorded); !read) return tl::unexpected(read.error());
    timeline.Add(std::move(recorded));
  }
  ParticipantEyes eyes = std::move(timeline).Finish(page);
  eyes.recording.name =
      fs::absolute(folder / "").lexically_normal().parent_path().filename().string();
  const auto keys = StepKeys(folder);
  for (Mark& mark : eyes.recording.marks) {
    const auto step = mark.keys.find("step");
    const auto known = step == mark.keys.end() ? keys.end() : keys.find(step->second);
    if (known != keys.end()) mark.keys.insert(known->second.begin(), known->second.end());
  }
  const auto& pupils = eyes.recording.pupils;
  if (pupils.empty() || pupils.back().time_s - pupils.front().time_s <= kDayS) return eyes;
  return Fail(ErrorCode::kMalformed,
              fmt::format("{}: its pupils are {:.0f} h apart; a day is the limit", folder.string(),
                          (pupils.back().time_s - pupils.front().time_s) / 3600.0));
}

Result<MeasuredParticipant> MeasureParticipant(const fs::path& folder, const PupilRules& rules,
                                               const ExclusionRules& exclusion) {
  const auto eyes = ReadParticipantEyes(folder);
  if (!eyes) return tl::unexpected(eyes.error());
  MeasuredParticipant measured;
  if (eyes->recording.pupils.empty()) return measured;
  const auto periods = PeriodsOf(eyes->recording.marks, measured.problems);
  for (TrialMeasures& trial :
       MeasureTrials(eyes->recording, periods, eyes->areas, rules, exclusion)) {
    std::string step = trial.trial.Key("step");
    measured.trials.push_back({std::move(step), std::move(trial)});
  }
  return measured;
}

}  // namespace conav::gaze
