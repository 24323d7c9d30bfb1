#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/gaze/eye_measures.h"
#include "study/report_page.h"

// One user: tables and pictures stand apart from the command line.
namespace conav::gaze {

/// What one recording gave.
struct MeasuredRecording {
  std::string file;
  std::string participant;
  std::vector<TrialMeasures> trials;
  std::vector<std::string> problems;  // of its marks
  /// Gaze samples on the page over all trials, and the areas in the middle of each trial, by method.
  std::map<std::string, std::vector<double>> heat;
  std::map<std::string, std::vector<Area>> areas;
  /// Of each trial, in their order.
  std::vector<MapGaze> maps;
};

/// The method of a trial; "all" if its marks name none.
std::string MethodOf(const TrialMeasures& measures);

/// One row per trial; docs/gaze.md says what each column is. Areas that one recording lacks are empty.
std::string TrialsCsv(const std::vector<MeasuredRecording>& recordings);

/// Participant x method, the mean over the trials that count: for `conav stats`. By name: pcpd,
/// diameter, blink_rate, shift_rate.
std::map<std::string, std::string> MeasureTables(const std::vector<MeasuredRecording>& recordings);

nlohmann::ordered_json GazeJson(const std::vector<MeasuredRecording>& recordings);

/// Per method n, mean and SD over participants, as table 2 of the paper; and what does not count.
std::vector<study::ReportSection> GazeSections(const std::vector<MeasuredRecording>& recordings);

/// Mean pupil diameter per method over normalised time, with 95 % intervals over participants (figure
/// 4); the SVG element for a page.
std::string CurvesPlot(const std::vector<MeasuredRecording>& recordings);

/// Gaze on the page under `method` over all participants, with areas and their fixation rates (figure
/// 6); the SVG element for a page. Empty without samples.
std::string HeatPlot(const std::vector<MeasuredRecording>& recordings, const std::string& method);

/// Looks at cells of the map: a row per trial and cell that was looked at.
std::string MapCellsCsv(const std::vector<MeasuredRecording>& recordings);

/// Gaze on the map's cells over all participants, for each method with one maze (layout and rotation of
/// the marks); the SVG elements for a page, by title.
std::vector<std::pair<std::string, std::string>> MapPlots(
    const std::vector<MeasuredRecording>& recordings);

/// One self-contained page with all of it.
std::string GazePage(const std::vector<MeasuredRecording>& recordings,
                     const study::Provenance& provenance);

/// In the order in which they first appear.
std::vector<std::string> MethodsIn(const std::vector<MeasuredRecording>& recordings);

}  // namespace conav::gaze
