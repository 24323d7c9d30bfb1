#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "study/gaze/csv_rows.h"
#include "study/gaze/eye_measures.h"
#include "study/gaze/gaze_report.h"
#include "study/gaze/participant_eye.h"

// conav-gaze: what an eye tracker recorded during the study.

namespace conav::gaze {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "conav gaze";

struct GazeArguments {
  std::vector<fs::path> recordings;
  fs::path marks;
  fs::path areas;
  AreasOfInterest interest;
  PupilRules rules;
  ExclusionRules exclusion;
  fs::path out = "gaze";
  fs::path json;
};

/// Of the whole study, with UTC times.
struct StudyFiles {
  std::vector<Mark> marks;
  std::vector<AreaLayout> layouts;
};

Result<StudyFiles> ReadStudyFiles(const GazeArguments& arguments) {
  StudyFiles files;
  if (!arguments.marks.empty()) {
    auto marks = ReadMarks(arguments.marks);
    if (!marks) return tl::unexpected(marks.error());
    files.marks = *std::move(marks);
  }
  if (!arguments.areas.empty()) {
    auto layouts = ReadAreas(arguments.areas);
    if (!layouts) return tl::unexpected(layouts.error());
    files.layouts = *std::move(layouts);
  }
  return files;
}

/// Adds the study's marks that fall into the recording, and moves its layouts to the recording's clock.
Result<void> UseStudyFiles(const StudyFiles& files, EyeRecording& recording,
                           AreasOfInterest& interest, const fs::path& folder) {
  if (files.marks.empty() && files.layouts.empty()) return {};
  if (!recording.utc_offset_s) {
    return Fail(ErrorCode::kMalformed,
                folder.string() +
                    ": info.player.json with its start in both clocks is missing, so that --marks "
                    "and --areas cannot be placed in time");
  }
  const double begin = recording.pupils.front().time_s;
  const double end = recording.pupils.back().time_s;
  for (Mark mark : files.marks) {
    mark.time_s -= *recording.utc_offset_s;
    if (mark.time_s >= begin && mark.time_s <= end) recording.marks.push_back(std::move(mark));
  }
  std::ranges::stable_sort(recording.marks, {}, &Mark::time_s);
  for (AreaLayout layout : files.layouts) {
    layout.time_s -= *recording.utc_offset_s;
    interest.layouts.push_back(std::move(layout));
  }
  std::ranges::stable_sort(interest.layouts, {}, &AreaLayout::time_s);
  return {};
}

/// Of Pupil Capture or Player, or of the bus; then `interest` gets its layouts.
Result<EyeRecording> Read(const fs::path& folder, AreasOfInterest& interest) {
  if (!HasBusRecordings(folder)) return ReadEyeRecording(folder);
  auto eyes = ReadParticipantEyes(folder, interest.page);
  if (!eyes) return tl::unexpected(eyes.error());
  if (eyes->recording.pupils.empty()) {
    return Fail(
        ErrorCode::kNotFound,
        folder.string() + ": its recordings have no pupils: was conav-eye-tracker running?");
  }
  interest = std::move(eyes->areas);
  return std::move(eyes->recording);
}

Result<MeasuredRecording> Measure(const GazeArguments& arguments, const StudyFiles& files,
                                  const fs::path& folder) {
  AreasOfInterest interest = arguments.interest;
  auto recording = Read(folder, interest);
  if (!recording) return tl::unexpected(recording.error());
  if (auto used = UseStudyFiles(files, *recording, interest, folder); !used) {
    return tl::unexpected(used.error());
  }
  MeasuredRecording measured{.file = folder.string(), .participant = recording->name};
  const std::vector<Period> periods = PeriodsOf(recording->marks, measured.problems);
  measured.trials =
      MeasureTrials(*recording, periods, interest, arguments.rules, arguments.exclusion);
  if (measured.trials.empty()) measured.problems.emplace_back("has no trial");
  for (const TrialMeasures& trial : measured.trials) {
    const std::string participant = trial.trial.Key("participant");
    if (!participant.empty()) measured.participant = participant;
    const std::string method = MethodOf(trial);
    const std::vector<double> heat =
        HeatMap(*recording, trial.trial, interest.page, arguments.rules.least_confidence);
    auto& sum = measured.heat[method];
    sum.resize(heat.size());
    for (std::size_t i = 0; i < heat.size(); ++i) sum[i] += heat[i];
    measured.maps.push_back(
        MapGazeOf(*recording, trial.trial, interest, arguments.rules.least_confidence));
    const double middle = 0.5 * (trial.trial.begin_s + trial.trial.end_s);
    const auto after = std::ranges::upper_bound(interest.layouts, middle, {}, &AreaLayout::time_s);
    if (after != interest.layouts.begin()) measured.areas[method] = std::prev(after)->areas;
  }
  return measured;
}

Result<void> WriteAll(const GazeArguments& arguments,
                      const std::vector<MeasuredRecording>& recordings,
                      const study::Provenance& provenance) {
  std::error_code error;
  fs::create_directories(arguments.out / "measures", error);
  if (error) {
    return Fail(ErrorCode::kIo, fmt::format("{}: cannot create this folder: {}",
                                            arguments.out.string(), error.message()));
  }
  Result<void> written =
      WriteFile(arguments.out / "trials.csv", TrialsCsv(recordings)).and_then([&] {
        return WriteFile(arguments.out / "map_cells.csv", MapCellsCsv(recordings));
      });
  for (const auto& [name, table] : MeasureTables(recordings)) {
    if (!written) return written;
    written = WriteFile(arguments.out / "measures" / (name + ".csv"), table);
  }
  return written
      .and_then(
          [&] { return WriteFile(arguments.out / "gaze.html", GazePage(recordings, provenance)); })
      .and_then([&] { return WriteJsonOutput(arguments.json, GazeJson(recordings)); });
}

int Run(const GazeArguments& arguments, const study::Provenance& provenance) {
  const int code =
      CheckFiles(kProgram, {{"--marks", arguments.marks}, {"--areas", arguments.areas}},
                 {{"--json", arguments.json}});
  if (code != 0) return code;
  const auto files = ReadStudyFiles(arguments);
  if (!files) return Failed(kProgram, files.error());
  std::vector<MeasuredRecording> recordings;
  for (const fs::path& folder : arguments.recordings) {
    fmt::print(stderr, "{}: reading {} ({} of {})\n", kProgram, folder.string(),
               recordings.size() + 1, arguments.recordings.size());
    auto measured = Measure(arguments, *files, folder);
    if (!measured) return Failed(kProgram, measured.error());
    recordings.push_back(*std::move(measured));
  }
  const auto sections = GazeSections(recordings);
  const std::string text = study::SectionsText(sections);
  if (arguments.json == "-") {
    fmt::print(stderr, "{}", text);
  } else if (auto printed = WriteStandardOutput(text); !printed) {
    return Failed(kProgram, printed.error());
  }
  if (auto written = WriteAll(arguments, recordings, provenance); !written) {
    return Failed(kProgram, written.error());
  }
  fmt::print(stderr, "{}: wrote {}\n", kProgram, (arguments.out / "gaze.html").string());
  const bool any = std::ranges::any_of(
      recordings, [](const MeasuredRecording& recording) { return !recording.trials.empty(); });
  return any ? 0
             : Failed(kProgram,
                      {ErrorCode::kNotFound,
                       "no recording has a trial: no marks 'trial begin' and 'trial end'"});
}

constexpr const char* kAbout =
    R"(Measures of an eye tracker, as the paper's user study has them (section 6.2, appendix D):

  PCPD          (diameter - baseline) / baseline in %, each eye against its own baseline; mean and SD over a trial
  blink rate    blinks that begin in the trial, per minute
  shift rate    fixations that are on another area than the fixation on an area before, per minute
  and fixation rates and dwell by area, pupil curves (figure 4), gaze over the page (figure 6)

RECORDING is the folder of a Pupil Core recording (info.player.json, *.pldata), what Pupil Player exported of it, or a
participant's folder of conav study --live (the recordings of conav-eye-tracker below it; marks and areas are in them, too).
Annotations tell what happens: "baseline begin", "baseline end", "trial begin", "trial end", with the keys
participant, method, layout, part. --marks and --areas add those of CSV files with UTC times. docs/gaze.md has the rules
by which samples and trials are left out.

Writes gaze.html, trials.csv (a row per trial), map_cells.csv (which cells of the map were looked at) and
measures/NAME.csv (for conav stats) into --out.)";

constexpr const char* kFooter =
    R"(Examples:
  conav gaze recordings/P0*/000 --out eyes
  conav gaze runs/study-pilot/P0* --out eyes
  conav stats eyes/measures/pcpd.csv

Exit codes: 0 done; 1 a recording cannot be read or has another format, or none has a trial; 2 wrong usage.)";

}  // namespace
}  // namespace conav::gaze

int main(int argc, char** argv) {
  using conav::Between;
  CLI::App app(conav::gaze::kAbout, conav::gaze::kProgram);
  app.footer(conav::gaze::kFooter);
  conav::gaze::GazeArguments arguments;
  app.add_option("recordings", arguments.recordings,
                 "Folders of recordings, exports or participants")
      ->required()
      ->type_name("RECORDING");
  conav::AddShown(app, "--out", arguments.out, "Folder for page and tables");
  app.add_option("--json", arguments.json,
                 "Write every trial to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.add_option("--marks", arguments.marks, "CSV: utc_s,label and keys");
  app.add_option("--areas", arguments.areas,
                 "CSV: utc_s,area,x,y,width,height in shares of the page, y down");
  conav::AddShown(app, "--page", arguments.interest.page, "The surface of the whole page");
  conav::AddNumber(app, "--confidence", arguments.rules.least_confidence,
                   "Lowest confidence of a sample that counts", 0.0, 1.0);
  conav::AddNumber(app, "--valid-share", arguments.exclusion.least_valid_share,
                   "Least share of a trial with diameters", 0.0, 1.0);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return conav::gaze::Run(arguments, conav::study::DescribeRun("conav gaze", argc, argv));
}
