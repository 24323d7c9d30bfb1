#include "study/gaze/eye_measures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <span>

#include "study/statistics/moments.h"

namespace conav::gaze {
namespace {

using statistics::Mean;
using statistics::Median;

constexpr double kMinuteS = 60.0;

// --- Periods and areas ------------------------------------------------------

constexpr std::string_view kBegin = " begin";
constexpr std::string_view kEnd = " end";

const AreaLayout* LayoutAt(const std::vector<AreaLayout>& layouts, double time_s) {
  const auto after = std::ranges::upper_bound(layouts, time_s, {}, &AreaLayout::time_s);
  return after == layouts.begin() ? nullptr : &*std::prev(after);
}

/// Empty = none. `y` up, as surfaces have it.
std::string AreaAt(const AreaLayout* layout, double x, double y) {
  if (layout == nullptr) return {};
  const auto found =
      std::ranges::find_if(layout->areas, [&](const Area& area) { return area.Has(x, 1.0 - y); });
  return found == layout->areas.end() ? std::string() : found->name;
}

// --- Samples of one eye -----------------------------------------------------

using Samples = std::vector<PupilSample>;

template <class Keep>
void KeepIf(Samples& samples, Keep keep) {
  std::erase_if(samples, [&](const PupilSample& sample) { return !keep(sample); });
}

/// mm per s, the faster of both sides.
std::vector<double> SpeedsOf(const Samples& samples) {
  std::vector<double> speeds(samples.size(), 0.0);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double time = samples[i].time_s - samples[i - 1].time_s;
    const double speed =
        time > 0.0 ? std::abs(samples[i].diameter - samples[i - 1].diameter) / time : 0.0;
    speeds[i - 1] = std::max(speeds[i - 1], speed);
    speeds[i] = speed;
  }
  return speeds;
}

void DropFast(Samples& samples, double factor) {
  if (samples.size() < 3) return;
  const std::vector<double> speeds = SpeedsOf(samples);
  const double middle = Median(speeds);
  std::vector<double> deviations;
  for (const double speed : speeds) deviations.push_back(std::abs(speed - middle));
  const double limit = middle + factor * Median(deviations);
  Samples kept;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (speeds[i] <= limit) kept.push_back(samples[i]);
  }
  samples = std::move(kept);
}

void DropEdgesOfGaps(Samples& samples, const PupilRules& rules) {
  std::vector<std::pair<double, double>> unsafe;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double before = samples[i - 1].time_s;
    const double after = samples[i].time_s;
    if (after - before <= rules.gap_s) continue;
    unsafe.emplace_back(before - rules.gap_padding_s, after + rules.gap_padding_s);
  }
  std::size_t next = 0;
  KeepIf(samples, [&](const PupilSample& sample) {
    while (next < unsafe.size() && unsafe[next].second < sample.time_s) ++next;
    return next == unsafe.size() || sample.time_s < unsafe[next].first;
  });
}

void DropBlinks(Samples& samples, const std::vector<Blink>& blinks) {
  KeepIf(samples, [&](const PupilSample& sample) {
    return std::ranges::none_of(blinks, [&](const Blink& blink) {
      return sample.time_s >= blink.begin_s && sample.time_s <= blink.end_s;
    });
  });
}

/// Linear between valid samples that are close enough.
PupilSeries Interpolated(const Samples& samples, int eye, double begin_s, double end_s,
                         const PupilRules& rules) {
  PupilSeries series{eye, begin_s, rules.rate_hz, {}};
  const auto count = static_cast<std::size_t>(std::floor((end_s - begin_s) * rules.rate_hz)) + 1;
  series.diameters.resize(count);
  std::size_t right = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double time = series.TimeOf(i);
    while (right < samples.size() && samples[right].time_s < time) ++right;
    if (right == samples.size()) break;
    if (samples[right].time_s == time) series.diameters[i] = samples[right].diameter;
    if (right == 0 || series.diameters[i]) continue;
    const PupilSample& left = samples[right - 1];
    const double gap = samples[right].time_s - left.time_s;
    if (gap > rules.longest_filled_s) continue;
    const double share = (time - left.time_s) / gap;
    series.diameters[i] = left.diameter + share * (samples[right].diameter - left.diameter);
  }
  return series;
}

PupilSeries CleanEye(const EyeRecording& recording, int eye, const PupilRules& rules) {
  Samples samples = recording.pupils;
  KeepIf(samples, [&](const PupilSample& sample) { return sample.eye == eye; });
  KeepIf(samples, [&](const PupilSample& sample) {
    const bool in_range =
        !recording.in_mm || (sample.diameter >= rules.least_mm && sample.diameter <= rules.most_mm);
    return sample.confidence >= rules.least_confidence && in_range && sample.diameter > 0.0;
  });
  DropFast(samples, rules.speed_factor);
  DropEdgesOfGaps(samples, rules);
  DropBlinks(samples, recording.blinks);
  return Interpolated(samples, eye, recording.pupils.front().time_s, recording.pupils.back().time_s,
                      rules);
}

// --- A trial ----------------------------------------------------------------

std::pair<std::size_t, std::size_t> IndicesOf(const PupilSeries& series, const Period& period) {
  const auto index = [&](double time_s) {
    const double steps = std::ceil((time_s - series.begin_s) * series.rate_hz);
    return static_cast<std::size_t>(
        std::clamp(steps, 0.0, static_cast<double>(series.diameters.size())));
  };
  return {index(period.begin_s), index(period.end_s)};
}

std::vector<double> ValuesIn(const PupilSeries& series, const Period& period) {
  std::vector<double> values;
  const auto [begin, end] = IndicesOf(series, period);
  for (std::size_t i = begin; i < end; ++i) {
    if (series.diameters[i]) values.push_back(*series.diameters[i]);
  }
  return values;
}

/// The mean of each eye in the baseline; empty where it is too short.
std::vector<std::optional<double>> BaselinesOf(const std::vector<PupilSeries>& eyes,
                                               const Period& baseline,
                                               const ExclusionRules& exclusion) {
  std::vector<std::optional<double>> means;
  for (const PupilSeries& series : eyes) {
    const std::vector<double> values = ValuesIn(series, baseline);
    const double seconds = static_cast<double>(values.size()) / series.rate_hz;
    means.push_back(!values.empty() && seconds >= exclusion.least_baseline_s
                        ? std::optional(Mean(values))
                        : std::nullopt);
  }
  return means;
}

/// The pauses of a recording.
struct Pauses {
  std::vector<Period> all;

  bool Has(double time_s) const {
    return std::ranges::any_of(all, [&](const Period& pause) { return pause.Has(time_s); });
  }
  /// s of `trial` that are paused.
  double SecondsIn(const Period& trial) const {
    double seconds = 0.0;
    for (const Period& pause : all) {
      const double begin = std::max(pause.begin_s, trial.begin_s);
      seconds += std::max(0.0, std::min(pause.end_s, trial.end_s) - begin);
    }
    return seconds;
  }
};

/// The mean over the eyes of `value` at each grid point of the trial that is in no pause; empty where no
/// eye has one.
template <class Value>
std::vector<std::optional<double>> OverEyes(const std::vector<PupilSeries>& eyes,
                                            const Period& trial, const Pauses& pauses,
                                            Value value) {
  std::vector<std::optional<double>> means;
  if (eyes.empty()) return means;
  const auto [begin, end] = IndicesOf(eyes.front(), trial);
  for (std::size_t i = begin; i < end; ++i) {
    if (pauses.Has(eyes.front().TimeOf(i))) continue;
    std::vector<double> values;
    for (std::size_t eye = 0; eye < eyes.size(); ++eye) {
      const auto& diameter = eyes[eye].diameters[i];
      const std::optional<double> found = diameter ? value(eye, *diameter) : std::nullopt;
      if (found) values.push_back(*found);
    }
    means.push_back(values.empty() ? std::nullopt : std::optional(Mean(values)));
  }
  return means;
}

std::vector<double> Present(const std::vector<std::optional<double>>& values) {
  std::vector<double> present;
  for (const auto& value : values) {
    if (value) present.push_back(*value);
  }
  return present;
}

std::optional<double> MeanOf(const std::vector<std::optional<double>>& values) {
  const std::vector<double> present = Present(values);
  return present.empty() ? std::nullopt : std::optional(Mean(present));
}

std::vector<std::optional<double>> CurveOf(const std::vector<std::optional<double>>& diameters) {
  std::vector<std::optional<double>> points(kCurvePoints);
  if (diameters.size() < 2) return points;
  const double last = static_cast<double>(diameters.size() - 1);
  for (std::size_t i = 0; i < kCurvePoints; ++i) {
    const double at = last * static_cast<double>(i) / static_cast<double>(kCurvePoints - 1);
    points[i] = diameters[static_cast<std::size_t>(std::lround(at))];
  }
  std::vector<std::optional<double>> smooth(kCurvePoints);
  constexpr std::size_t kHalf = kCurveWindow / 2;
  for (std::size_t i = 0; i < kCurvePoints; ++i) {
    const std::size_t begin = i < kHalf ? 0 : i - kHalf;
    const std::size_t end = std::min(i + kHalf + 1, kCurvePoints);
    smooth[i] = MeanOf({points.begin() + static_cast<std::ptrdiff_t>(begin),
                        points.begin() + static_cast<std::ptrdiff_t>(end)});
  }
  return smooth;
}

void MeasurePupils(TrialMeasures& measures, const std::vector<PupilSeries>& eyes,
                   const Pauses& pauses, const Period* baseline, const ExclusionRules& exclusion) {
  const auto diameters = OverEyes(eyes, measures.trial, pauses,
                                  [](std::size_t, double d) { return std::optional(d); });
  measures.diameter_mean = MeanOf(diameters);
  measures.curve = CurveOf(diameters);
  const auto valid = static_cast<double>(Present(diameters).size());
  if (!diameters.empty()) measures.valid_share = valid / static_cast<double>(diameters.size());
  if (measures.valid_share < exclusion.least_valid_share) {
    measures.problem =
        fmt::format("{:.0f} % of the trial has a valid diameter, less than {:.0f} %",
                    100.0 * measures.valid_share, 100.0 * exclusion.least_valid_share);
    return;
  }
  if (baseline == nullptr) {
    measures.problem = "no baseline ends before it";
    return;
  }
  const auto baselines = BaselinesOf(eyes, *baseline, exclusion);
  measures.baseline = MeanOf(baselines);
  if (!measures.baseline) {
    measures.problem = fmt::format("its baseline has less than {} s of valid diameters",
                                   exclusion.least_baseline_s);
    return;
  }
  // Appendix D.1.
  auto changes = OverEyes(eyes, measures.trial, pauses, [&](std::size_t eye, double d) {
    return baselines[eye] ? std::optional(100.0 * (d - *baselines[eye]) / *baselines[eye])
                          : std::nullopt;
  });
  const std::vector<double> pcpd = Present(changes);
  if (pcpd.empty()) {
    measures.problem = "the eye of its baseline has no valid diameter";
    return;
  }
  measures.pcpd_mean = Mean(pcpd);
  measures.pcpd_sd = statistics::StandardDeviation(pcpd);
  // The eyes differ in size: the mean of those that are seen would jump when one is lost.
  const auto diameter = [&](double change) { return *measures.baseline * (1.0 + change / 100.0); };
  measures.diameter_mean = diameter(*measures.pcpd_mean);
  for (auto& change : changes) {
    if (change) change = diameter(*change);
  }
  measures.curve = CurveOf(changes);
}

void MeasureFixations(TrialMeasures& measures, const std::vector<AreaFixation>& all,
                      const Pauses& pauses, const std::set<std::string>& areas) {
  const double minutes = measures.observed_s / kMinuteS;
  for (const std::string& area : areas) {
    measures.fixations_per_min[area] = 0.0;
    measures.dwell_share[area] = 0.0;
  }
  const AreaFixation* last = nullptr;
  int shifts = 0;
  for (const AreaFixation& fixation : all) {
    if (!measures.trial.Has(fixation.begin_s) || pauses.Has(fixation.begin_s)) continue;
    measures.fixations_per_min[fixation.area] += 1.0 / minutes;
    const double end = std::min(fixation.begin_s + fixation.duration_s, measures.trial.end_s);
    measures.dwell_share[fixation.area] += (end - fixation.begin_s) / measures.observed_s;
    if (last != nullptr && last->area != fixation.area) ++shifts;
    last = &fixation;
  }
  measures.shifts_per_min = shifts / minutes;
}

}  // namespace

std::string Period::Key(const std::string& name) const {
  const auto found = keys.find(name);
  return found == keys.end() ? std::string() : found->second;
}

std::vector<Period> PeriodsOf(const std::vector<Mark>& marks, std::vector<std::string>& problems) {
  std::vector<Period> periods;
  std::map<std::string, Period> open;
  for (const Mark& mark : marks) {
    const std::string_view label = mark.label;
    if (label.ends_with(kBegin)) {
      const std::string kind(label.substr(0, label.size() - kBegin.size()));
      const auto begun = open.find(kind);
      const auto step = mark.keys.find("step");
      const bool goes_on = begun != open.end() && step != mark.keys.end() &&
                           begun->second.Key("step") == step->second;
      if (goes_on) continue;
      if (begun != open.end()) problems.push_back(kind + " begins again before it has ended");
      open[kind] = {kind, mark.time_s, mark.time_s, mark.keys};
    } else if (label.ends_with(kEnd)) {
      const std::string kind(label.substr(0, label.size() - kEnd.size()));
      auto begun = open.extract(kind);
      if (!begun) {
        problems.push_back(kind + " ends without having begun");
        continue;
      }
      begun.mapped().end_s = mark.time_s;
      begun.mapped().keys.insert(mark.keys.begin(), mark.keys.end());
      periods.push_back(std::move(begun.mapped()));
    }
  }
  for (const auto& [kind, period] : open) problems.push_back(kind + " does not end");
  std::ranges::stable_sort(periods, {}, &Period::begin_s);
  return periods;
}

std::vector<AreaFixation> FixationsOnAreas(const EyeRecording& recording,
                                           const AreasOfInterest& areas) {
  std::vector<AreaFixation> found;
  for (const auto& [name, surface] : recording.surfaces) {
    for (const Fixation& fixation : surface.fixations) {
      const std::string area =
          name == areas.page
              ? AreaAt(LayoutAt(areas.layouts, fixation.begin_s), fixation.x, fixation.y)
              : name;
      if (!area.empty()) found.push_back({area, fixation.begin_s, fixation.duration_s});
    }
  }
  std::ranges::stable_sort(found, {}, &AreaFixation::begin_s);
  return found;
}

std::vector<PupilSeries> CleanPupils(const EyeRecording& recording, const PupilRules& rules) {
  std::set<int> eyes;
  for (const PupilSample& sample : recording.pupils) eyes.insert(sample.eye);
  std::vector<PupilSeries> series;
  for (const int eye : eyes) series.push_back(CleanEye(recording, eye, rules));
  return series;
}

std::vector<TrialMeasures> MeasureTrials(const EyeRecording& recording,
                                         const std::vector<Period>& periods,
                                         const AreasOfInterest& areas, const PupilRules& rules,
                                         const ExclusionRules& exclusion) {
  const std::vector<PupilSeries> eyes = CleanPupils(recording, rules);
  const std::vector<AreaFixation> fixations = FixationsOnAreas(recording, areas);
  std::set<std::string> names;
  for (const AreaFixation& fixation : fixations) names.insert(fixation.area);
  Pauses pauses;
  std::ranges::copy_if(periods, std::back_inserter(pauses.all),
                       [](const Period& period) { return period.kind == "pause"; });
  std::vector<TrialMeasures> measured;
  const Period* baseline = nullptr;
  for (const Period& period : periods) {
    if (period.kind == "baseline") baseline = &period;
    const double observed_s = period.duration_s() - pauses.SecondsIn(period);
    if (period.kind != "trial" || !(observed_s > 0.0)) continue;
    TrialMeasures measures{.trial = period, .observed_s = observed_s};
    const bool has_baseline = baseline != nullptr && baseline->end_s <= period.begin_s;
    MeasurePupils(measures, eyes, pauses, has_baseline ? baseline : nullptr, exclusion);
    const auto blinks = std::ranges::count_if(recording.blinks, [&](const Blink& blink) {
      return period.Has(blink.begin_s) && !pauses.Has(blink.begin_s);
    });
    measures.blinks_per_min = static_cast<double>(blinks) / (observed_s / kMinuteS);
    if (!recording.surfaces.empty()) MeasureFixations(measures, fixations, pauses, names);
    measured.push_back(std::move(measures));
  }
  return measured;
}

std::vector<double> HeatMap(const EyeRecording& recording, const Period& trial,
                            const std::string& surface, double least_confidence) {
  std::vector<double> counts(static_cast<std::size_t>(kHeatColumns * kHeatRows), 0.0);
  const auto found = recording.surfaces.find(surface);
  if (found == recording.surfaces.end()) return counts;
  for (const GazeSample& gaze : found->second.gaze) {
    if (!trial.Has(gaze.time_s) || gaze.confidence < least_confidence) continue;
    if (gaze.x < 0.0 || gaze.x >= 1.0 || gaze.y <= 0.0 || gaze.y > 1.0) continue;
    const int column = static_cast<int>(gaze.x * kHeatColumns);
    const int row = static_cast<int>((1.0 - gaze.y) * kHeatRows);
    counts[static_cast<std::size_t>(row * kHeatColumns + column)] += 1.0;
  }
  return counts;
}

void MapGaze::Add(const MapGaze& other) {
  if (other.rows != rows || other.columns != columns) {
    *this = other;
    return;
  }
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
}

MapGaze MapGazeOf(const EyeRecording& recording, const Period& trial, const AreasOfInterest& areas,
                  double least_confidence) {
  MapGaze map;
  const auto found = recording.surfaces.find(areas.page);
  if (found == recording.surfaces.end()) return map;
  for (const GazeSample& gaze : found->second.gaze) {
    if (!trial.Has(gaze.time_s) || gaze.confidence < least_confidence) continue;
    const AreaLayout* layout = LayoutAt(areas.layouts, gaze.time_s);
    if (layout == nullptr || !layout->map || AreaAt(layout, gaze.x, gaze.y) != "map") continue;
    const MapOnPage& place = *layout->map;
    const double row = std::floor((1.0 - gaze.y - place.y) / place.dy + 0.5);
    const double column = std::floor((gaze.x - place.x) / place.dx + 0.5);
    if (row < 0.0 || row >= place.rows || column < 0.0 || column >= place.columns) continue;
    if (map.rows != place.rows || map.columns != place.columns) {
      map = {place.rows, place.columns,
             std::vector<double>(static_cast<std::size_t>(place.rows * place.columns), 0.0)};
    }
    map.counts[static_cast<std::size_t>(row * place.columns + column)] += 1.0;
  }
  return map;
}

}  // namespace conav::gaze
