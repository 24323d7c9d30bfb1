#include "study/supervision_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/runtime/threads.h"
#include "study/study_folder.h"
#include "study/study_run.h"
#include "study/supervision_options.h"
#include "study/supervision_player.h"
#include "study/supervision_report.h"

namespace conav::study {
namespace {

constexpr const char* kProgram = "conav study --supervision";

constexpr const char* kAbout =
    R"(One operator, many robots, with a SIMULATED operator: every number of robots with every order of
the attention queue and every seed, all services as processes of their own over DDS. Prints
throughput, waiting times, utilisation and fan-out, measured and predicted (NT/IT + 1, the same with
waits, the finite-source queue M/M/1//N), and paired tests of the orders. Details:
docs/supervision.md.

Simulation time passes at a fixed speed while the operator thinks. By default each robot is in a world of
its own (--robots-per-world); worlds take the methods in turn. The operator selects the first item of the
published queue, is busy for its interaction time, and answers. Thread timing matters: the same seeds
give the same worlds and interaction times, but not the same figures to the last digit.

Each trial is on disk once it has ended: after a kill the same command resumes, and one with more
--seeds, --robots or --orders adds trials. --out must not hold another design. A trial that fails runs a
second time; then the report names it and leaves it out, and the same command tries it again.)";

constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 a trial failed, interrupted or writing failed; 2 wrong usage.";

struct Arguments {
  SupervisionOptions options;
  std::string interaction_times;
  bool is_supervision = false;
};

void AddOptions(CLI::App& app, Arguments& arguments) {
  SupervisionOptions& options = arguments.options;
  app.add_flag("--supervision", arguments.is_supervision,
               "Run this study instead of the one of the methods");
  app.add_option("--robots", options.robots, "Numbers of robots, each 1 to 16")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--orders", options.orders, "Orders of the attention queue")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--methods", options.methods, "ig-mcts, instruction: of the worlds in turn")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--interaction-times", arguments.interaction_times,
                 "Means in simulation seconds, log-normal, log_sd=0 for fixed ones "
                 "[picture=4,blocked=6,path=6,log_sd=0.5]");
  app.add_option("--seeds", options.seeds,
                 "Number of seeds, each with every number of robots and order")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "The first seed")
      ->check(WholeNumber())
      ->capture_default_str();
  app.add_option("--minutes", options.minutes, "Simulation time of a trial")->capture_default_str();
  app.add_option("--goals", options.goals, "Goals of each robot; more than it can reach")
      ->capture_default_str();
  app.add_option("--robots-per-world", options.robots_per_world, "Robots that share a maze")
      ->capture_default_str();
  app.add_option(
         "--answer-timeout", options.answer_timeout_s,
         "Simulation seconds after which a robot continues without an answer to its picture")
      ->capture_default_str();
  app.add_option("--speed", options.speed, "Simulated seconds per second")->capture_default_str();
  app.add_option("--jobs", options.jobs, "Trials at once")->capture_default_str();
  app.add_option("--dds", options.dds, "cyclonedds or fastdds");
  app.add_option("--out", options.out, "Folder of the study [one in runs/, named by the design]");
  app.add_option("--json", options.json,
                 "Write the result to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.footer(kExitCodes);
}

using TrialStore = RecordStore<SupervisionRecord>;

Result<void> Play(const SupervisionOptions& options, const std::vector<SupervisionTrial>& trials,
                  TrialStore& store, const StopToken& stop) {
  const SteadyClock clock;
  const auto programs = std::filesystem::canonical("/proc/self/exe").parent_path();
  std::vector<std::string> names;
  for (const SupervisionTrial& trial : trials) names.push_back(trial.name());
  const PiecePlayer<SupervisionRecord> play = [&](int, std::size_t index) {
    return PlayTrial(trials[index], options, programs, clock, stop);
  };
  ProgressLine line;
  return RunPieces(names, options.jobs, play, store, stop, ShowOn(line, "trials"));
}

Result<void> WriteFiles(const SupervisionOptions& options, const SupervisionSummary& summary,
                        const std::vector<SupervisionRecord>& records, const StudyFolder& folder,
                        const Provenance& provenance) {
  const nlohmann::ordered_json json = SupervisionJson(options, summary);
  const std::pair<const char*, std::string> files[] = {
      {"trials.csv", SupervisionCsv(records)},
      {"results.json", JsonText(json)},
      {"supervision.svg", SupervisionPlot(options, summary)},
      {"report.html",
       SupervisionPage(options, summary, ProvenanceSection(provenance, DesignOf(options)))}};
  for (const auto& [name, text] : files) {
    if (auto written = folder.Write(name, text); !written) return written;
  }
  return WriteJsonOutput(options.json, json);
}

int Report(const SupervisionOptions& options, const std::vector<SupervisionRecord>& records,
           const StudyFolder& folder, const Provenance& provenance) {
  const SupervisionSummary summary = Summarise(options, records);
  if (const auto written = WriteFiles(options, summary, records, folder, provenance); !written) {
    return Failed(kProgram, written.error());
  }
  const std::string text = fmt::format(
      "{}\n{} holds report.html, supervision.svg, trials.csv, results.json and all runs\n",
      SupervisionText(options, summary), folder.path().string());
  const auto printed = PrintTables(text, options.json);
  return printed && !summary.failed.empty() ? 1 : ExitCode(kProgram, printed);
}

int Run(SupervisionOptions options, const Provenance& provenance, const StopToken& stop) {
  const auto design = DesignOf(options);
  if (options.out.empty()) options.out = DefaultSupervisionOut(Fingerprint(design));
  if (const int code = CheckFiles(kProgram, {}, {{"--json", options.json}}); code != 0) return code;
  const auto folder = StudyFolder::Open(std::filesystem::absolute(options.out), design);
  if (!folder) return RefusedFolder(kProgram, folder.error());
  auto store = TrialStore::Open(*folder, "trials");
  if (!store) return Failed(kProgram, store.error());
  const std::vector<SupervisionTrial> trials = TrialsOf(options);
  if (const auto played = Play(options, trials, *store, stop); !played) {
    return Failed(kProgram, played.error());
  }
  std::vector<SupervisionRecord> records;
  for (const SupervisionTrial& trial : trials) {
    const auto found = store->records().find(trial.name());
    if (found != store->records().end()) records.push_back(found->second);
  }
  if (!stop.stop_requested()) return Report(options, records, *folder, provenance);
  return Interrupted(kProgram, records.size(), trials.size(), "trials", *folder);
}

}  // namespace

int SupervisionMain(int argc, char** argv) {
  CLI::App app(kAbout, kProgram);
  Arguments arguments;
  AddOptions(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  auto valid = ParseInteractionTimes(arguments.interaction_times, arguments.options.interaction);
  if (valid) valid = Validate(arguments.options);
  if (!valid) return Refused(kProgram, valid.error().text);
  log::SetService("study");
  log::SetMinimumLevel(log::Level::kError);
  InstallStopSignals();
  return Run(arguments.options, DescribeRun(argc, argv), ProcessStopToken());
}

}  // namespace conav::study
