#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "launcher/demo_plan.h"
#include "study/report_page.h"
#include "study/study_run.h"
#include "study/waterway.h"
#include "study/waterway_figure.h"

// conav-waterway: the study of `conav study --world waterway`, and figure 7 by `conav figure waterway`.

namespace conav::study {
namespace {

constexpr const char* kStudyProgram = "conav study --world";
constexpr const char* kFigureProgram = "conav figure";

constexpr const char* kStudyAbout =
    R"(Waterways (the paper's section 6.3) with a SIMULATED operator: in the world of every seed a robot
crosses from one end to the other by an outdated map, once with greedy search, once with IG-MCTS and an
operator, once with IG-MCTS and an operator who never answers, all services as processes of their own over
DDS. Prints, per way of driving, goals reached, the path driven over the shortest drive on the true map,
pictures, and whether the bars are met. The worlds are drawn so that a dead end tempts a greedy robot.

Each crossing is on disk once it has ended: after a kill the same command resumes. --out must not hold
another design. Details: docs/waterway.md.)";

constexpr const char* kFigureAbout =
    R"(Figure 7 of the paper: crosses the waterway of a seed with greedy search and with IG-MCTS and a
SIMULATED operator, and draws (a) the truth and both ways, (b) the operator's map, (c) the robot's map with
its navigation graph, (d) a picture that was sent, (e) the edits predicted after it, as one SVG page. The
two run folders stay in --out.)";

constexpr const char* kStudyExitCodes =
    R"(Exit codes: 0 done; 1 a crossing failed, interrupted, writing failed, or with --check a bar missed;
2 wrong usage.)";

constexpr const char* kFigureExitCodes =
    "Exit codes: 0 done; 1 a crossing failed, interrupted or writing failed; 2 wrong usage.";

/// What both commands take.
void AddCommonOptions(CLI::App& app, WaterwayOptions& options, std::string& world) {
  app.add_option("world", world, "waterway")->required()->check(CLI::IsMember({"waterway"}));
  AddShown(app, "--camera", options.camera, "egl renders pictures; none sends them without pixels");
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  AddShown(app, "--time-limit", options.time_limit_s,
           "Time limit of a crossing, seconds of wall time");
}

int RunStudy(WaterwayOptions options, const SlurmRun& slurm, const StopToken& stop) {
  if (const auto valid = Validate(options); !valid) {
    return Refused(kStudyProgram, valid.error().text);
  }
  if (const int code = CheckFiles(kStudyProgram, {}, {{"--json", options.json}}); code != 0) {
    return code;
  }
  const auto design = DesignOf(options);
  if (options.out.empty()) options.out = fmt::format("runs/waterway-{:.8}", Fingerprint(design));
  StudyRun<EpisodeRecord> run{.program = kStudyProgram,
                              .pieces = "crossings",
                              .out = options.out,
                              .json = options.json,
                              .design = design,
                              .jobs = options.jobs,
                              .slurm = slurm};
  const std::vector<WaterwayTrial> trials = TrialsOf(options);
  for (const WaterwayTrial& trial : trials) run.names.push_back(trial.name());
  const SteadyClock clock;
  const auto programs = std::filesystem::canonical("/proc/self/exe").parent_path();
  std::vector<DemoPlayer> players;
  for (int job = 0; job < options.jobs; ++job) players.emplace_back(programs, clock, stop);
  run.play = [&](int job, std::size_t index) {
    const auto folder = std::filesystem::absolute(options.out) / "runs" / trials[index].name();
    return players[static_cast<std::size_t>(job)].Play(trials[index].name(),
                                                       DemoOf(trials[index], options, folder));
  };
  run.report = [&](const WaterwayRecords& records) {
    const WaterwaySummary summary = Summarise(options, records);
    Results results{
        .text = fmt::format("{}\n{} holds trials.csv, results.json and all runs\n",
                            WaterwayText(summary), std::filesystem::absolute(options.out).string()),
        .json = WaterwayJson(summary, design),
        .files = {{"trials.csv", WaterwayCsv(options, records)}}};
    results.passed = summary.failed.empty() &&
                     (!options.check || std::ranges::all_of(BarsOf(summary), &WaterwayBar::met));
    return results;
  };
  return Run(run, stop);
}

int StudyMain(int argc, char** argv) {
  CLI::App app(kStudyAbout, kStudyProgram);
  app.footer(kStudyExitCodes);
  WaterwayOptions options;
  std::string world;
  AddCommonOptions(app, options, world);
  AddShown(app, "--seeds", options.seeds, "How many worlds");
  AddSeed(app, "--first-seed", options.first_seed, "Seed of the first world");
  options.jobs = 1;
  AddShown(app, "--jobs", options.jobs,
           "Crossings at once; more than one for every two cores changes the decision times");
  app.add_option("--out", options.out, "Folder of the study [one in runs/, named by the design]");
  app.add_option("--json", options.json,
                 "Write the result to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.add_flag("--check", options.check, "Exit with 1 when a bar is missed");
  SlurmRun slurm;
  AddSlurmOptions(app, slurm, argc, argv);
  if (const auto ended = Parse(app, argc, argv)) return *ended;
  return RunStudy(std::move(options), slurm, ProcessStopToken());
}

/// The run folder of a crossing that was played now. Errors: kUnavailable with what ended it.
Result<std::filesystem::path> PlayOne(DemoPlayer& player, const WaterwayTrial& trial,
                                      const WaterwayOptions& options) {
  const EpisodeRecord record = player.Play(trial.name(), DemoOf(trial, options, options.out));
  if (record.measures) {
    if (!record.is_complete()) Warn(kFigureProgram, trial.name() + ": " + record.detail);
    return record.run;
  }
  return Fail(ErrorCode::kUnavailable, fmt::format("{}: {}", trial.name(), record.detail));
}

int FigureMain(int argc, char** argv) {
  CLI::App app(kFigureAbout, kFigureProgram);
  app.footer(kFigureExitCodes);
  WaterwayOptions options{.seeds = 1, .out = "runs"};
  std::string world;
  std::filesystem::path svg = "waterway.svg";
  AddCommonOptions(app, options, world);
  AddSeed(app, "--seed", options.first_seed, "Seed of the world");
  AddShown(app, "--svg", svg, "The page; - = standard output");
  AddShown(app, "--out", options.out, "Folder for the run folders");
  if (const auto ended = Parse(app, argc, argv)) return *ended;
  if (const auto valid = Validate(options); !valid) {
    return Refused(kFigureProgram, valid.error().text);
  }
  if (const int code = CheckFiles(kFigureProgram, {}, {{"--svg", svg}}); code != 0) return code;
  const SteadyClock clock;
  const auto programs = std::filesystem::canonical("/proc/self/exe").parent_path();
  DemoPlayer player(programs, clock, ProcessStopToken());
  std::map<Crossing, std::filesystem::path> runs;
  for (const Crossing crossing : {Crossing::kGreedy, Crossing::kGuided}) {
    fmt::print(stderr, "{}: crossing the waterway of seed {} with {}\n", kFigureProgram,
               options.first_seed, TitleOf(crossing));
    const auto run = PlayOne(player, {options.first_seed, crossing}, options);
    if (!run) return Failed(kFigureProgram, run.error());
    runs[crossing] = *run;
  }
  const auto page = WaterwayFigure(runs[Crossing::kGreedy], runs[Crossing::kGuided]);
  if (!page) return Failed(kFigureProgram, page.error());
  return ExitCode(kFigureProgram, WriteOutput(svg, *page));
}

int Main(int argc, char** argv) {
  log::SetService("waterway");
  log::SetMinimumLevel(log::Level::kError);
  InstallStopSignals();
  const std::string_view command = argc > 1 ? argv[1] : "";
  const bool is_study = command == "study";
  if (!is_study && command != "figure") {
    return Refused("conav-waterway", "the first word is study or figure");
  }
  argv[1] = argv[0];
  try {
    return is_study ? StudyMain(argc - 1, argv + 1) : FigureMain(argc - 1, argv + 1);
  } catch (const StartupError& error) {
    return Failed(is_study ? kStudyProgram : kFigureProgram,
                  {ErrorCode::kInvalidArgument, error.what()});
  }
}

}  // namespace
}  // namespace conav::study

int main(int argc, char** argv) { return conav::study::Main(argc, argv); }
