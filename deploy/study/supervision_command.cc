#include "study/supervision_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>

#include "common/console/console.h"
#include "common/console/progress_line.h"
#include "common/runtime/json.h"
#include "common/runtime/log.h"
#include "common/runtime/workers.h"
#include "study/supervision_player.h"
#include "study/supervision_report.h"

namespace conav::study {
namespace {

constexpr const char* kProgram = "conav study --supervision";

constexpr const char* kAbout =
    R"(One operator, many robots, with a SIMULATED operator: every number of robots with every order of
the attention queue and every seed, all services as processes of their own over DDS. Prints
throughput, waiting times, utilisation and fan-out, measured and predicted (NT/IT + 1, the same with
waits, the finite-source queue M/M/1//N), and paired tests of the orders. docs/supervision.md says
more.

Simulation time passes at a fixed speed while the operator thinks. Each robot is in a world of its own
unless --robots-per-world says otherwise; worlds have the methods in turn. The operator takes what is
first in the published queue, selects it, is busy for its interaction time, and answers. Thread timing
enters: equal seeds give the same worlds and interaction times, not the same figures to the last
digit.)";

constexpr const char* kExitCodes =
    "Exit codes: 0 done; 1 a trial failed, interrupted or writing failed; 2 wrong use.";

struct Arguments {
  SupervisionOptions options;
  std::string interaction_times;
  bool is_supervision = false;
};

void AddOptions(CLI::App& app, Arguments& arguments) {
  SupervisionOptions& options = arguments.options;
  app.add_flag("--supervision", arguments.is_supervision,
               "This study rather than that of the methods");
  app.add_option("--robots", options.robots, "Numbers of robots")
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
  app.add_option("--seeds", options.seeds, "Seeds, each with every number and order")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "The first of them")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--minutes", options.minutes, "Simulation time of a trial")->capture_default_str();
  app.add_option("--goals", options.goals, "Of each robot; more than it can reach")
      ->capture_default_str();
  app.add_option("--robots-per-world", options.robots_per_world, "Robots that share a maze")
      ->capture_default_str();
  app.add_option("--answer-timeout", options.answer_timeout_s,
                 "Simulation seconds after which a robot goes on without an answer to its picture")
      ->capture_default_str();
  app.add_option("--speed", options.speed, "Simulated seconds per second")->capture_default_str();
  app.add_option("--jobs", options.jobs, "Trials at once")->capture_default_str();
  app.add_option("--dds", options.dds, "cyclonedds or fastdds");
  app.add_option("--out", options.out, "Folder of the study")->capture_default_str();
  app.add_option("--json", options.json, "Write the result to this file, too");
  app.footer(kExitCodes);
}

std::vector<SupervisionRecord> PlayAll(const SupervisionOptions& options, const StopToken& stop) {
  const SteadyClock clock;
  const auto program_folder = std::filesystem::canonical("/proc/self/exe").parent_path();
  const std::vector<SupervisionTrial> trials = TrialsOf(options);
  std::vector<SupervisionRecord> records(trials.size());
  ProgressLine progress;
  std::mutex mutex;  // guards progress, done
  std::size_t done = 0;
  const auto start = clock.Now();
  RunOnWorkers(options.jobs, static_cast<int>(trials.size()), [&](int, int index) {
    const auto i = static_cast<std::size_t>(index);
    records[i].trial = trials[i];
    records[i].failure = "interrupted";
    if (stop.stop_requested()) return;
    records[i] = PlayTrial(trials[i], options, program_folder, clock, stop);
    const std::lock_guard lock(mutex);
    ++done;
    const double spent_s = std::chrono::duration<double>(clock.Now() - start).count();
    const double left_s =
        spent_s / static_cast<double>(done) * static_cast<double>(trials.size() - done);
    progress.Show(fmt::format("{}/{} trials, {} left; {}: {}", done, trials.size(),
                              DurationText(left_s), trials[i].name(),
                              records[i].failure.empty()
                                  ? fmt::format("{:.0f} goals", records[i].goals)
                                  : records[i].failure));
  });
  return records;
}

Result<void> WriteFiles(const SupervisionOptions& options, const SupervisionSummary& summary,
                        const std::vector<SupervisionRecord>& records) {
  const nlohmann::ordered_json json = SupervisionJson(options, summary);
  const std::pair<const char*, std::string> files[] = {
      {"trials.csv", SupervisionCsv(records)},
      {"results.json", JsonText(json)},
      {"supervision.svg", SupervisionPlot(options, summary)},
      {"report.html", SupervisionPage(options, summary)}};
  for (const auto& [name, text] : files) {
    if (auto written = WriteOutput(options.out / name, text); !written) return written;
  }
  return WriteJsonOutput(options.json, json);
}

int Run(const SupervisionOptions& options, const StopToken& stop) {
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) {
    return Failed(kProgram, {ErrorCode::kIo, fmt::format("{}: cannot make this folder: {}",
                                                         options.out.string(), error.message())});
  }
  if (const int code = CheckFiles(
          kProgram, {}, {{"--json", options.json}, {"--out", options.out / "trials.csv"}});
      code != 0) {
    return code;
  }
  const std::vector<SupervisionRecord> records = PlayAll(options, stop);
  const SupervisionSummary summary = Summarise(options, records);
  if (const auto written = WriteFiles(options, summary, records); !written) {
    return Failed(kProgram, written.error());
  }
  const auto printed = WriteStandardOutput(SupervisionText(options, summary));
  return printed && !summary.failed.empty() ? 1 : ExitCode(kProgram, printed);
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
  return Run(arguments.options, ProcessStopToken());
}

}  // namespace conav::study
