#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/gaze/eye_recording.h"

namespace conav::gaze {

/// From a mark "<kind> begin" to the next "<kind> end". The keys are those of both marks.
struct Period {
  std::string kind;  // trial, baseline, training, rest
  double begin_s = 0.0;
  double end_s = 0.0;
  std::map<std::string, std::string> keys;

  double duration_s() const { return end_s - begin_s; }
  bool Has(double time_s) const { return time_s >= begin_s && time_s < end_s; }
  /// Empty if the marks have no such key.
  std::string Key(const std::string& name) const;
};

/// A period that is not ended, or ends without having begun, is left out and named in `problems`. One that
/// begins again with the same `step` goes on: a program was restarted in it.
std::vector<Period> PeriodsOf(const std::vector<Mark>& marks, std::vector<std::string>& problems);

/// A rectangle of the page, in shares of its width and height; y DOWN from the upper edge.
struct Area {
  std::string name;  // picture, map, queue, ...
  double x = 0.0;
  double y = 0.0;
  double width = 0.0;
  double height = 0.0;

  bool Has(double at_x, double at_y) const {
    return at_x >= x && at_x < x + width && at_y >= y && at_y < y + height;
  }
};

/// The map on the page, in shares as Area: the centre of cell (row, column) is at (x + column * dx,
/// y + row * dy).
struct MapOnPage {
  double x = 0.0;
  double y = 0.0;
  double dx = 0.0;
  double dy = 0.0;
  int rows = 0;
  int columns = 0;
};

/// The areas of interest from `time_s` on. The first one that has a position counts.
struct AreaLayout {
  double time_s = 0.0;
  std::vector<Area> areas;
  std::optional<MapOnPage> map;
};

/// Where the areas of interest are. With a surface called `page` (the tags around conav's page), the
/// layouts tell; other surfaces are areas themselves.
struct AreasOfInterest {
  std::string page = "page";
  std::vector<AreaLayout> layouts;  // ordered by time
};

/// A fixation on an area.
struct AreaFixation {
  std::string area;
  double begin_s = 0.0;
  double duration_s = 0.0;
};

/// The fixations on areas, by time; those outside of all areas are not among them.
std::vector<AreaFixation> FixationsOnAreas(const EyeRecording& recording,
                                           const AreasOfInterest& areas);

/// How pupil samples are judged: Kret and Sjak-Shie, "Preprocessing pupil size data: Guidelines and
/// code", 2019, with their defaults, per eye and in this order: confidence, range, speed, gaps, blinks,
/// interpolation. Speed and gaps are theirs; their trend line and low-pass filters are left out, as a
/// mean over a trial needs neither.
struct PupilRules {
  double least_confidence = 0.6;
  double least_mm = 1.5;  // of diameters in mm
  double most_mm = 9.0;
  /// Samples faster than median + factor x median absolute deviation of all speeds are left out.
  double speed_factor = 16.0;
  /// Samples within `gap_padding_s` of a gap longer than `gap_s` are left out, too: lids cover the
  /// pupil before they hide it.
  double gap_s = 0.075;
  double gap_padding_s = 0.05;
  /// Gaps up to this are filled linearly.
  double longest_filled_s = 0.25;
  /// Grid of the result; unequal frame rates do not weigh.
  double rate_hz = 60.0;
};

/// One eye's diameters on a regular grid; empty = no valid one there.
struct PupilSeries {
  int eye = 0;
  double begin_s = 0.0;
  double rate_hz = 60.0;
  std::vector<std::optional<double>> diameters;

  double TimeOf(std::size_t index) const { return begin_s + static_cast<double>(index) / rate_hz; }
};

/// One series for each eye that has samples, over the whole recording.
std::vector<PupilSeries> CleanPupils(const EyeRecording& recording, const PupilRules& rules);

/// When a trial counts.
struct ExclusionRules {
  double least_valid_share = 0.5;  // of the trial's grid points
  double least_baseline_s = 3.0;   // of valid diameters
};

/// What one trial measures. Empty = cannot be said, with the reason in `problem`.
struct TrialMeasures {
  Period trial;
  double observed_s = 0.0;  // its duration without pauses, of which all below is measured
  std::string problem;      // why the pupils do not count; empty = they do
  double valid_share = 0.0;
  /// PCPD_t = (diameter_t - baseline) / baseline in % (appendix D.1), each eye against its own
  /// baseline, mean of the eyes; its mean and SD over the trial.
  std::optional<double> pcpd_mean;
  std::optional<double> pcpd_sd;
  /// With a baseline: (1 + PCPD) x `baseline`, so that a lost eye makes no jump; likewise `curve`.
  std::optional<double> diameter_mean;
  std::optional<double> baseline;  // mean of the eyes
  std::optional<double> blinks_per_min;
  std::optional<double> shifts_per_min;             // of fixations from one area to another
  std::map<std::string, double> fixations_per_min;  // by area
  std::map<std::string, double> dwell_share;        // of the trial's time in fixations, by area
  /// Diameters over the trial at kCurvePoints times, smoothed over kCurveWindow of them (figure 4).
  std::vector<std::optional<double>> curve;
};

inline constexpr std::size_t kCurvePoints = 1000;
inline constexpr std::size_t kCurveWindow = 5;

/// All trials of a recording. A trial's baseline is the last one that ended before it.
std::vector<TrialMeasures> MeasureTrials(const EyeRecording& recording,
                                         const std::vector<Period>& periods,
                                         const AreasOfInterest& areas, const PupilRules& rules,
                                         const ExclusionRules& exclusion);

inline constexpr int kHeatColumns = 64;
inline constexpr int kHeatRows = 36;

/// Gaze samples on the page by place, row 0 at its upper edge: figure 6. Row-major.
std::vector<double> HeatMap(const EyeRecording& recording, const Period& trial,
                            const std::string& surface, double least_confidence);

/// Gaze samples by cell of the map, row-major. No rows where no layout has a map.
struct MapGaze {
  int rows = 0;
  int columns = 0;
  std::vector<double> counts;

  /// Sums, or replaces a map of another size.
  void Add(const MapGaze& other);
};

/// Which cells were looked at: samples on the page whose area is called `map`, by the layout of their
/// time.
MapGaze MapGazeOf(const EyeRecording& recording, const Period& trial, const AreasOfInterest& areas,
                  double least_confidence);

}  // namespace conav::gaze
