#include "study/gaze/gaze_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "common/plot/axes.h"
#include "study/statistics/moments.h"

namespace conav::gaze {
namespace {

using statistics::Mean;
using statistics::StandardDeviation;
using Recordings = std::vector<MeasuredRecording>;

/// A measure of table 2.
struct Measure {
  const char* name;
  const char* title;
  std::optional<double> TrialMeasures::*value;
};

constexpr std::array kMeasures{
    Measure{"pcpd", "PCPD, %", &TrialMeasures::pcpd_mean},
    Measure{"diameter", "pupil diameter", &TrialMeasures::diameter_mean},
    Measure{"blink_rate", "blinks per min", &TrialMeasures::blinks_per_min},
    Measure{"shift_rate", "fixation shifts per min", &TrialMeasures::shifts_per_min}};

/// Figures of pupils that do not count are left out.
std::optional<double> Counted(const TrialMeasures& measures, const Measure& measure) {
  const bool is_of_pupils =
      measure.value == &TrialMeasures::pcpd_mean || measure.value == &TrialMeasures::diameter_mean;
  if (is_of_pupils && !measures.problem.empty()) return std::nullopt;
  return measures.*measure.value;
}

std::set<std::string> AreasIn(const Recordings& recordings) {
  std::set<std::string> areas;
  for (const MeasuredRecording& recording : recordings) {
    for (const TrialMeasures& trial : recording.trials) {
      for (const auto& [area, rate] : trial.fixations_per_min) areas.insert(area);
    }
  }
  return areas;
}

/// The participants in the order in which they first appear.
std::vector<std::string> ParticipantsIn(const Recordings& recordings) {
  std::vector<std::string> names;
  for (const MeasuredRecording& recording : recordings) {
    if (std::ranges::find(names, recording.participant) == names.end()) {
      names.push_back(recording.participant);
    }
  }
  return names;
}

/// A participant's mean over the trials with one method; empty without any.
std::optional<double> ParticipantMean(const Recordings& recordings, const std::string& participant,
                                      const std::string& method, const Measure& measure) {
  std::vector<double> values;
  for (const MeasuredRecording& recording : recordings) {
    if (recording.participant != participant) continue;
    for (const TrialMeasures& trial : recording.trials) {
      const auto value = Counted(trial, measure);
      if (value && MethodOf(trial) == method) values.push_back(*value);
    }
  }
  return values.empty() ? std::nullopt : std::optional(Mean(values));
}

std::optional<double> AreaRate(const Recordings& recordings, const std::string& method,
                               const std::string& area) {
  std::vector<double> rates;
  for (const MeasuredRecording& recording : recordings) {
    for (const TrialMeasures& trial : recording.trials) {
      const auto found = trial.fixations_per_min.find(area);
      if (MethodOf(trial) == method && found != trial.fixations_per_min.end()) {
        rates.push_back(found->second);
      }
    }
  }
  return rates.empty() ? std::nullopt : std::optional(Mean(rates));
}

std::string MeanText(const std::vector<double>& values) {
  if (values.empty()) return "-";
  if (values.size() == 1) return fmt::format("{:.2f}", values.front());
  return fmt::format("{:.2f} ({:.2f})", Mean(values), StandardDeviation(values));
}

study::ReportSection MethodTable(const Recordings& recordings) {
  study::ReportSection section{.title = "Eye measures: mean (SD) over participants",
                               .header = {"method", "participants"}};
  for (const Measure& measure : kMeasures) section.header.emplace_back(measure.title);
  for (const std::string& method : MethodsIn(recordings)) {
    std::vector<std::string> row{method};
    std::size_t most = 0;
    for (const Measure& measure : kMeasures) {
      std::vector<double> values;
      for (const std::string& participant : ParticipantsIn(recordings)) {
        const auto mean = ParticipantMean(recordings, participant, method, measure);
        if (mean) values.push_back(*mean);
      }
      most = std::max(most, values.size());
      row.push_back(MeanText(values));
    }
    row.insert(row.begin() + 1, fmt::format("{}", most));
    section.rows.push_back(std::move(row));
  }
  return section;
}

study::ReportSection AreaTable(const Recordings& recordings) {
  study::ReportSection section{.title = "Fixations per minute on each area", .header = {"method"}};
  const std::set<std::string> areas = AreasIn(recordings);
  section.header.insert(section.header.end(), areas.begin(), areas.end());
  for (const std::string& method : MethodsIn(recordings)) {
    std::vector<std::string> row{method};
    for (const std::string& area : areas) {
      const auto rate = AreaRate(recordings, method, area);
      row.push_back(rate ? fmt::format("{:.1f}", *rate) : "-");
    }
    section.rows.push_back(std::move(row));
  }
  return section;
}

study::ReportSection LeftOutTable(const Recordings& recordings) {
  study::ReportSection section{.title = "What does not count", .header = {}};
  for (const MeasuredRecording& recording : recordings) {
    for (const std::string& problem : recording.problems) {
      section.remarks.push_back(fmt::format("{}: {}", recording.file, problem));
    }
    for (const TrialMeasures& trial : recording.trials) {
      if (trial.problem.empty()) continue;
      section.remarks.push_back(fmt::format("{}: trial at {:.1f} s ({}): its pupils: {}",
                                            recording.file, trial.trial.begin_s, MethodOf(trial),
                                            trial.problem));
    }
  }
  if (section.remarks.empty()) section.remarks.emplace_back("Everything counts.");
  return section;
}

// --- Figure 4 ---------------------------------------------------------------

constexpr std::array kColors{"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00"};

/// The participants' mean curves of one method.
std::vector<std::vector<std::optional<double>>> CurvesOf(const Recordings& recordings,
                                                         const std::string& method) {
  std::vector<std::vector<std::optional<double>>> curves;
  for (const std::string& participant : ParticipantsIn(recordings)) {
    std::vector<std::vector<double>> values(kCurvePoints);
    for (const MeasuredRecording& recording : recordings) {
      if (recording.participant != participant) continue;
      for (const TrialMeasures& trial : recording.trials) {
        if (!trial.problem.empty() || MethodOf(trial) != method) continue;
        for (std::size_t i = 0; i < trial.curve.size(); ++i) {
          if (trial.curve[i]) values[i].push_back(*trial.curve[i]);
        }
      }
    }
    std::vector<std::optional<double>> mean(kCurvePoints);
    for (std::size_t i = 0; i < kCurvePoints; ++i) {
      if (!values[i].empty()) mean[i] = Mean(values[i]);
    }
    curves.push_back(std::move(mean));
  }
  return curves;
}

/// Mean and 95 % interval over participants at each point where someone has a value.
struct Band {
  std::vector<double> at;  // share of the trial
  std::vector<double> mean;
  std::vector<statistics::Interval> interval;
};

Band BandOf(const Recordings& recordings, const std::string& method) {
  const auto curves = CurvesOf(recordings, method);
  Band band;
  for (std::size_t i = 0; i < kCurvePoints; ++i) {
    std::vector<double> values;
    for (const auto& curve : curves) {
      if (curve[i]) values.push_back(*curve[i]);
    }
    if (values.empty()) continue;
    band.at.push_back(static_cast<double>(i) / static_cast<double>(kCurvePoints - 1));
    band.mean.push_back(Mean(values));
    const double n = static_cast<double>(values.size());
    band.interval.push_back(values.size() < 2
                                ? statistics::Interval{band.mean.back(), band.mean.back()}
                                : statistics::StudentInterval(
                                      band.mean.back(), StandardDeviation(values) / std::sqrt(n),
                                      n - 1.0, statistics::kAlpha));
  }
  return band;
}

// --- Figure 6 ---------------------------------------------------------------

/// Row-major counts as squares of `pixels`.
void DrawHeat(SvgCanvas& canvas, const std::vector<double>& counts, int columns, double pixels) {
  const double most = std::ranges::max(counts);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] <= 0.0) continue;
    const auto width = static_cast<std::size_t>(columns);
    canvas.Rectangle(
        {static_cast<double>(i % width) * pixels, static_cast<double>(i / width) * pixels}, pixels,
        pixels,
        fmt::format("fill=\"#D55E00\" fill-opacity=\"{:.3f}\"", std::sqrt(counts[i] / most)));
  }
}

}  // namespace

std::string MethodOf(const TrialMeasures& measures) {
  const std::string method = measures.trial.Key("method");
  return method.empty() ? "all" : method;
}

std::vector<std::string> MethodsIn(const Recordings& recordings) {
  std::vector<std::string> methods;
  for (const MeasuredRecording& recording : recordings) {
    for (const TrialMeasures& trial : recording.trials) {
      const std::string method = MethodOf(trial);
      if (std::ranges::find(methods, method) == methods.end()) methods.push_back(method);
    }
  }
  return methods;
}

std::string TrialsCsv(const Recordings& recordings) {
  const std::set<std::string> areas = AreasIn(recordings);
  std::string csv =
      "participant,recording,method,layout,part,begin_s,duration_s,counts,valid_share,baseline,"
      "diameter_mean,pcpd_mean,pcpd_sd,blinks_per_min,shifts_per_min";
  for (const std::string& area : areas) {
    csv += fmt::format(",{},{}", study::CsvText("fixations_per_min_" + area),
                       study::CsvText("dwell_share_" + area));
  }
  csv += "\n";
  for (const MeasuredRecording& recording : recordings) {
    for (const TrialMeasures& trial : recording.trials) {
      csv += fmt::format("{},{},{},{},{},{},{},{},{}", study::CsvText(recording.participant),
                         study::CsvText(std::filesystem::path(recording.file).filename().string()),
                         study::CsvText(MethodOf(trial)), study::CsvText(trial.trial.Key("layout")),
                         study::CsvText(trial.trial.Key("part")), trial.trial.begin_s,
                         trial.trial.duration_s(), trial.problem.empty() ? "yes" : "no",
                         trial.valid_share);
      for (const auto& value : {trial.baseline, trial.diameter_mean, trial.pcpd_mean, trial.pcpd_sd,
                                trial.blinks_per_min, trial.shifts_per_min}) {
        csv += study::CsvCell(value);
      }
      for (const std::string& area : areas) {
        const bool known = trial.fixations_per_min.contains(area);
        csv += known ? fmt::format(",{},{}", trial.fixations_per_min.at(area),
                                   trial.dwell_share.at(area))
                     : ",,";
      }
      csv += "\n";
    }
  }
  return csv;
}

std::map<std::string, std::string> MeasureTables(const Recordings& recordings) {
  const std::vector<std::string> methods = MethodsIn(recordings);
  std::map<std::string, std::string> tables;
  for (const Measure& measure : kMeasures) {
    std::string csv = "subject";
    for (const std::string& method : methods) csv += fmt::format(",{}", study::CsvText(method));
    csv += "\n";
    for (const std::string& participant : ParticipantsIn(recordings)) {
      csv += study::CsvText(participant);
      for (const std::string& method : methods) {
        csv += study::CsvCell(ParticipantMean(recordings, participant, method, measure));
      }
      csv += "\n";
    }
    tables[measure.name] = std::move(csv);
  }
  return tables;
}

nlohmann::ordered_json GazeJson(const Recordings& recordings) {
  nlohmann::ordered_json trials = nlohmann::ordered_json::array();
  for (const MeasuredRecording& recording : recordings) {
    for (const TrialMeasures& trial : recording.trials) {
      trials.push_back({{"participant", recording.participant},
                        {"recording", recording.file},
                        {"method", MethodOf(trial)},
                        {"keys", trial.trial.keys},
                        {"begin_s", trial.trial.begin_s},
                        {"duration_s", trial.trial.duration_s()},
                        {"problem", trial.problem},
                        {"valid_share", trial.valid_share},
                        {"baseline", study::NumberJson(trial.baseline)},
                        {"diameter_mean", study::NumberJson(trial.diameter_mean)},
                        {"pcpd_mean", study::NumberJson(trial.pcpd_mean)},
                        {"pcpd_sd", study::NumberJson(trial.pcpd_sd)},
                        {"blinks_per_min", study::NumberJson(trial.blinks_per_min)},
                        {"shifts_per_min", study::NumberJson(trial.shifts_per_min)},
                        {"fixations_per_min", trial.fixations_per_min},
                        {"dwell_share", trial.dwell_share}});
    }
  }
  nlohmann::ordered_json problems = nlohmann::ordered_json::array();
  for (const MeasuredRecording& recording : recordings) {
    for (const std::string& problem : recording.problems) {
      problems.push_back(recording.file + ": " + problem);
    }
  }
  return {{"trials", std::move(trials)}, {"problems", std::move(problems)}};
}

std::vector<study::ReportSection> GazeSections(const Recordings& recordings) {
  std::vector<study::ReportSection> sections{MethodTable(recordings)};
  if (!AreasIn(recordings).empty()) sections.push_back(AreaTable(recordings));
  sections.push_back(LeftOutTable(recordings));
  return sections;
}

std::string CurvesPlot(const Recordings& recordings) {
  std::vector<std::pair<std::string, Band>> bands;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const std::string& method : MethodsIn(recordings)) {
    Band band = BandOf(recordings, method);
    if (band.at.empty()) continue;
    low = std::min(low, std::ranges::min(band.interval, {}, &statistics::Interval::low).low);
    high = std::max(high, std::ranges::max(band.interval, {}, &statistics::Interval::high).high);
    bands.emplace_back(method, std::move(band));
  }
  if (bands.empty()) return {};
  SvgCanvas canvas;
  const PlotArea area{.corner = {60.0, 16.0},
                      .width = 640.0,
                      .height = 300.0,
                      .x = {0.0, 1.0, 0.2},
                      .y = RoundAxis(low, high, 6)};
  area.Draw(canvas, "share of the trial", "pupil diameter");
  for (std::size_t m = 0; m < bands.size(); ++m) {
    const auto& [method, band] = bands[m];
    const char* color = kColors[m % kColors.size()];
    std::vector<PixelPosition> outline;
    std::vector<PixelPosition> line;
    for (std::size_t i = 0; i < band.at.size(); ++i) {
      line.push_back(area.At(band.at[i], band.mean[i]));
      outline.push_back(area.At(band.at[i], band.interval[i].high));
    }
    for (std::size_t i = band.at.size(); i-- > 0;) {
      outline.push_back(area.At(band.at[i], band.interval[i].low));
    }
    canvas.Polygon(outline, fmt::format("fill=\"{}\" fill-opacity=\"0.2\"", color));
    canvas.Polyline(line, fmt::format("stroke=\"{}\" stroke-width=\"2\"", color));
    canvas.Text({712.0, 30.0 + 20.0 * static_cast<double>(m)}, method,
                fmt::format("class=\"label\" style=\"fill:{}\"", color));
  }
  return canvas.Inline(840.0, 370.0, "Mean pupil diameter over the trial, by method");
}

std::string HeatPlot(const Recordings& recordings, const std::string& method) {
  std::vector<double> sum(static_cast<std::size_t>(kHeatColumns * kHeatRows), 0.0);
  const std::vector<Area>* areas = nullptr;
  for (const MeasuredRecording& recording : recordings) {
    const auto heat = recording.heat.find(method);
    if (heat == recording.heat.end()) continue;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += heat->second[i];
    const auto found = recording.areas.find(method);
    if (found != recording.areas.end()) areas = &found->second;
  }
  if (!(std::ranges::max(sum) > 0.0)) return {};
  constexpr double kPixels = 10.0;
  SvgCanvas canvas;
  canvas.Rectangle({0.0, 0.0}, kHeatColumns * kPixels, kHeatRows * kPixels,
                   "fill=\"#ffffff\" stroke=\"#888888\"");
  DrawHeat(canvas, sum, kHeatColumns, kPixels);
  if (areas != nullptr) {
    for (const Area& area : *areas) {
      const PixelPosition corner{area.x * kHeatColumns * kPixels, area.y * kHeatRows * kPixels};
      canvas.Rectangle(corner, area.width * kHeatColumns * kPixels,
                       area.height * kHeatRows * kPixels,
                       "fill=\"none\" stroke=\"#0072B2\" stroke-dasharray=\"6 4\"");
      const auto rate = AreaRate(recordings, method, area.name);
      canvas.Text({corner.x + 6.0, corner.y + 16.0},
                  rate ? fmt::format("{}: {:.1f} fixations per min", area.name, *rate) : area.name,
                  "font-size=\"12\" fill=\"#0072B2\"");
    }
  }
  return canvas.Inline(kHeatColumns * kPixels, kHeatRows * kPixels, "Gaze on the page, " + method);
}

std::string MapCellsCsv(const Recordings& recordings) {
  std::string csv = "participant,method,layout,rotation,part,step,begin_s,row,column,samples\n";
  for (const MeasuredRecording& recording : recordings) {
    for (std::size_t t = 0; t < recording.maps.size(); ++t) {
      const MapGaze& map = recording.maps[t];
      const TrialMeasures& trial = recording.trials[t];
      std::string begin = fmt::format("{},{}", study::CsvText(recording.participant),
                                      study::CsvText(MethodOf(trial)));
      for (const char* key : {"layout", "rotation", "part", "step"}) {
        begin += fmt::format(",{}", study::CsvText(trial.trial.Key(key)));
      }
      for (std::size_t i = 0; i < map.counts.size(); ++i) {
        if (map.counts[i] <= 0.0) continue;
        const auto columns = static_cast<std::size_t>(map.columns);
        csv += fmt::format("{},{},{},{},{}\n", begin, trial.trial.begin_s, i / columns, i % columns,
                           map.counts[i]);
      }
    }
  }
  return csv;
}

std::vector<std::pair<std::string, std::string>> MapPlots(const Recordings& recordings) {
  std::map<std::string, MapGaze> sums;
  for (const MeasuredRecording& recording : recordings) {
    for (std::size_t t = 0; t < recording.maps.size(); ++t) {
      const TrialMeasures& trial = recording.trials[t];
      std::string title = MethodOf(trial);
      for (const char* key : {"layout", "rotation"}) {
        const std::string value = trial.trial.Key(key);
        if (!value.empty()) title += fmt::format(", {} {}", key, value);
      }
      if (!recording.maps[t].counts.empty()) sums[title].Add(recording.maps[t]);
    }
  }
  std::vector<std::pair<std::string, std::string>> plots;
  for (const auto& [title, map] : sums) {
    const double pixels = std::max(2.0, std::floor(560.0 / std::max(map.rows, map.columns)));
    SvgCanvas canvas;
    canvas.Rectangle({0.0, 0.0}, map.columns * pixels, map.rows * pixels,
                     "fill=\"#ffffff\" stroke=\"#888888\"");
    DrawHeat(canvas, map.counts, map.columns, pixels);
    plots.emplace_back(
        title, canvas.Inline(map.columns * pixels, map.rows * pixels, "Gaze on the map, " + title));
  }
  return plots;
}

std::string GazePage(const Recordings& recordings, const study::Provenance& provenance) {
  std::string body = study::SectionsHtml(GazeSections(recordings));
  if (const std::string curves = CurvesPlot(recordings); !curves.empty()) {
    body += "<h2>Pupil diameter over the trial</h2>\n<figure>" + curves +
            "<figcaption>Mean over participants with its 95 % interval; 1000 points, smoothed over "
            "5.</figcaption></figure>\n";
  }
  for (const std::string& method : MethodsIn(recordings)) {
    const std::string heat = HeatPlot(recordings, method);
    if (heat.empty()) continue;
    body += fmt::format(
        "<h2>Gaze on the page: {}</h2>\n<figure>{}<figcaption>All participants; darker: more "
        "samples.</figcaption></figure>\n",
        EscapeXml(method), heat);
  }
  for (const auto& [title, plot] : MapPlots(recordings)) {
    body += fmt::format(
        "<h2>Gaze on the map: {}</h2>\n<figure>{}<figcaption>By cell, row 0 above; all "
        "participants; "
        "darker: more samples.</figcaption></figure>\n",
        EscapeXml(title), plot);
  }
  nlohmann::ordered_json design = {{"recordings", recordings.size()}};
  const std::array sections{study::ProvenanceSection(provenance, design)};
  return study::Page("Eye measures", body + study::SectionsHtml(sections));
}

}  // namespace conav::gaze
