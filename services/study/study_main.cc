#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>
#include <vector>

#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "common/runtime/random.h"
#include "common/runtime/text.h"
#include "common/runtime/threads.h"
#include "launcher/demo_plan.h"
#include "study/design.h"
#include "study/report.h"
#include "study/study_folder.h"
#include "study/study_run.h"
#include "study/supervision_options.h"
#include "study/supervision_player.h"
#include "study/supervision_report.h"

namespace conav::study {
namespace {

constexpr const char* kSupervisionProgram = "conav study --supervision";

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
    return Failed(kSupervisionProgram, written.error());
  }
  const std::string text = fmt::format(
      "{}\n{} holds report.html, supervision.svg, trials.csv, results.json and all runs\n",
      SupervisionText(options, summary), folder.path().string());
  const auto printed = PrintTables(text, options.json);
  return printed && !summary.failed.empty() ? 1 : ExitCode(kSupervisionProgram, printed);
}

int Run(SupervisionOptions options, const Provenance& provenance, const StopToken& stop) {
  const auto design = DesignOf(options);
  if (options.out.empty()) options.out = DefaultSupervisionOut(Fingerprint(design));
  if (const int code = CheckFiles(kSupervisionProgram, {}, {{"--json", options.json}}); code != 0)
    return code;
  const auto folder = StudyFolder::Open(std::filesystem::absolute(options.out), design);
  if (!folder) return RefusedFolder(kSupervisionProgram, folder.error());
  auto store = TrialStore::Open(*folder, "trials");
  if (!store) return Failed(kSupervisionProgram, store.error());
  const std::vector<SupervisionTrial> trials = TrialsOf(options);
  if (const auto played = Play(options, trials, *store, stop); !played) {
    return Failed(kSupervisionProgram, played.error());
  }
  std::vector<SupervisionRecord> records;
  for (const SupervisionTrial& trial : trials) {
    const auto found = store->records().find(trial.name());
    if (found != store->records().end()) records.push_back(found->second);
  }
  if (!stop.stop_requested()) return Report(options, records, *folder, provenance);
  return Interrupted(kSupervisionProgram, records.size(), trials.size(), "trials", *folder);
}

/// `conav study --supervision ...`: parses, runs all trials, prints the tables, writes trials.csv,
/// results.json, supervision.svg and report.html into --out. Exit code: 0 done; 1 a trial failed,
/// interrupted, or a file could not be written; 2 wrong usage.
int SupervisionMain(int argc, char** argv) {
  CLI::App app(kAbout, kSupervisionProgram);
  Arguments arguments;
  AddOptions(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  auto valid = ParseInteractionTimes(arguments.interaction_times, arguments.options.interaction);
  if (valid) valid = Validate(arguments.options);
  if (!valid) return Refused(kSupervisionProgram, valid.error().text);
  log::SetService("study");
  log::SetMinimumLevel(log::Level::kError);
  InstallStopSignals();
  return Run(arguments.options, DescribeRun(argc, argv), ProcessStopToken());
}

constexpr const char* kProgram = "conav study";

/// Purpose for DeriveSeed.
constexpr std::uint64_t kPeopleSeed = 4;

/// A study before its first episode.
struct Plan {
  Design design;
  std::vector<std::string> people;  // YAML, as design.subjects
  nlohmann::ordered_json document;
};

std::vector<std::string> DrawPeople(const StudyOptions& options, std::size_t count) {
  const auto population =
      options.population.empty() ? DefaultPopulation() : nhpm::ReadPopulation(options.population);
  const std::uint64_t seed = DeriveSeed(options.design.seed, kPeopleSeed);
  std::vector<std::string> people;
  for (std::size_t subject = 0; subject < count; ++subject) {
    people.push_back(PersonYaml(DrawPerson(population, DeriveSeed(seed, subject))));
  }
  return people;
}

nlohmann::ordered_json EpisodesJson(const Design& design) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PlannedEpisode& episode : design.episodes) {
    list.push_back({{"name", episode.name}, {"seed", episode.seed}});
  }
  return list;
}

/// Everything that the results depend on, except for the program itself.
Plan MakePlan(const StudyOptions& options) {
  Plan plan{.design = MakeDesign(options.design)};
  plan.people = DrawPeople(options, plan.design.subjects.size());
  plan.document = {{"operators", options.design.operators},
                   {"layouts", plan.design.layouts},
                   {"methods", plan.design.methods},
                   {"seed", options.design.seed},
                   {"robots", options.robots},
                   {"camera", options.camera},
                   {"dds", options.dds},
                   {"weights_checksum", launcher::WeightsChecksum(BaseDemo(options))},
                   {"time_limit_s", options.time_limit_s},
                   {"orders", plan.design.orders},
                   {"episodes", EpisodesJson(plan.design)},
                   {"people", plan.people}};
  return plan;
}

Result<void> WritePeople(const Plan& plan, const StudyFolder& folder) {
  for (std::size_t subject = 0; subject < plan.people.size(); ++subject) {
    const auto file =
        std::filesystem::relative(folder.person(plan.design.subjects[subject]), folder.path());
    if (auto written = folder.Write(file, plan.people[subject]); !written) return written;
  }
  return {};
}

Result<void> Play(const StudyOptions& options, const Plan& plan, const StudyFolder& folder,
                  EpisodeStore& store, const StopToken& stop) {
  const SteadyClock clock;
  const auto programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::unique_ptr<DemoPlayer>> players;
  for (int job = 0; job < options.jobs; ++job) {
    players.push_back(std::make_unique<DemoPlayer>(programs, clock, stop));
  }
  const launcher::DemoOptions base = BaseDemo(options);
  const EpisodePlayer play = [&](int job, const PlannedEpisode& episode) {
    const std::string& subject = plan.design.subjects[static_cast<std::size_t>(episode.subject)];
    return players[static_cast<std::size_t>(job)]->Play(DemoFor(base, episode, subject, folder));
  };
  ProgressLine line;
  return RunEpisodes(plan.design.episodes, options.jobs, play, store, stop,
                     ShowOn(line, "episodes"));
}

Result<void> WriteReports(const StudyReport& report, const StudyFolder& folder,
                          const std::filesystem::path& json_file) {
  const auto json = StudyJson(report);
  auto written = folder.Write("episodes.csv", EpisodesCsv(report))
                     .and_then([&] { return folder.Write("report.html", StudyPage(report)); })
                     .and_then([&] { return folder.Write("results.json", JsonText(json)); });
  for (std::size_t m = 0; written && m < Measures().size(); ++m) {
    if (!WasMeasured(report, Measures()[m])) continue;
    written =
        folder.Write(std::filesystem::path("measures") / fmt::format("{}.csv", Measures()[m].key),
                     report.summary.analyses[m].csv);
  }
  return written ? WriteJsonOutput(json_file, json) : written;
}

Result<void> Publish(const StudyReport& report, const StudyFolder& folder,
                     const std::filesystem::path& json_file) {
  if (auto written = WriteReports(report, folder, json_file); !written) return written;
  const std::string text =
      fmt::format("{}\n{} holds report.html, episodes.csv, measures/, results.json and all runs\n",
                  StudyText(report), folder.path().string());
  return PrintTables(text, json_file);
}

bool AllMet(const StudySummary& summary) {
  return std::all_of(summary.bars.begin(), summary.bars.end(),
                     [](const Bar& bar) { return bar.met(); });
}

int Run(StudyOptions options, const Provenance& provenance, const StopToken& stop) {
  const Plan plan = MakePlan(options);
  if (options.out.empty()) options.out = DefaultOut(options, Fingerprint(plan.document));
  const auto folder = StudyFolder::Open(std::filesystem::absolute(options.out), plan.document);
  if (!folder) return RefusedFolder(kProgram, folder.error());
  auto store = OpenEpisodes(*folder);
  if (!store) return Failed(kProgram, store.error());
  const auto played = WritePeople(plan, *folder).and_then([&] {
    return Play(options, plan, *folder, *store, stop);
  });
  if (!played) return Failed(kProgram, played.error());
  if (stop.stop_requested()) {
    return Interrupted(kProgram, store->records().size(), plan.design.episodes.size(), "episodes",
                       *folder);
  }
  const StudySummary summary = Summarise(plan.design, store->records());
  const StudyReport report{
      plan.design, plan.document, store->records(), summary, options.camera != "none", provenance};
  if (const auto published = Publish(report, *folder, options.json); !published) {
    return Failed(kProgram, published.error());
  }
  return summary.failed.empty() && (!options.check || AllMet(summary)) ? 0 : 1;
}

/// The whole study: resumes an earlier run of the same study, prints table 3, writes the files of
/// StudyFolder and --json. Exit code: 0 done; 1 an episode failed, it was interrupted, a file could
/// not be written, or a bar was missed with --check; 2 wrong usage.
int RunStudy(const StudyOptions& options, const Provenance& provenance, const StopToken& stop) {
  if (const auto valid = Validate(options); !valid) return Refused(kProgram, valid.error().text);
  const int code =
      CheckFiles(kProgram, {{"--population", options.population}, {"--weights", options.weights}},
                 {{"--json", options.json}});
  if (code != 0) return code;
  try {
    return Run(options, provenance, stop);
  } catch (const StartupError& error) {
    return Failed(kProgram, {ErrorCode::kInvalidArgument, error.what()});
  }
}

}  // namespace
}  // namespace conav::study

namespace {

constexpr const char* kAbout =
    R"(The paper's user study (section 6.2, table 3) with SIMULATED operators: every operator does
every method on every layout, each episode with all services as processes of their own over DDS. Prints,
per method, communication, steps, guidance, mapping accuracy, goals and time, the tests, and whether the
bars are met.

Design: a Williams design counterbalances the order of methods. Layouts are mazes 234, 666 and 9, then
random ones, turned by another quarter in each session. Operators are synthetic people, each drawn from
a population and the same in all methods. Details: docs/study.md.

Each episode is on disk once it has ended: after a kill the same command resumes. --out must not hold
another design. An episode that does not reach all goals runs a second time, then stays and is reported.

The study of one operator with many robots: conav study --supervision --help. With a person: conav study
--live --help.)";

constexpr const char* kExitCodes =
    R"(Exit codes: 0 done; 1 an episode failed, interrupted, writing failed, or with --check a bar missed;
2 wrong usage.)";

void AddOptions(CLI::App& app, conav::study::StudyOptions& options) {
  app.add_option("--operators", options.design.operators, "Simulated operators")
      ->capture_default_str();
  app.add_option("--layouts", options.design.layouts, "Mazes for each operator")
      ->capture_default_str();
  app.add_option("--methods", options.design.methods, "Methods of conav demo --method")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--robots", options.robots, "Robots per operator")->capture_default_str();
  app.add_option("--seed", options.design.seed, "Seed of orders, people and random layouts")
      ->check(conav::WholeNumber())
      ->capture_default_str();
  options.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--jobs", options.jobs, "Episodes at once [one per core]");
  app.add_option("--camera", options.camera, "egl renders pictures; none sends them without pixels")
      ->capture_default_str();
  app.add_option(
      "--population", options.population,
      "Population of operators, a file like deploy/config/annotators.yaml [its careful people]");
  app.add_option("--weights", options.weights,
                 "Weights file of the perception model [the one that comes with conav]");
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_flag("--recording", options.recording, "Record each episode, like conav demo");
  app.add_option("--time-limit", options.time_limit_s,
                 "Time limit of an episode, seconds of wall time")
      ->capture_default_str();
  app.add_option("--out", options.out, "Folder of the study [one in runs/, named by the design]");
  app.add_option("--json", options.json,
                 "Write the result to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.add_flag("--check", options.check, "Exit with 1 when a bar is missed");
  app.footer(kExitCodes);
}

}  // namespace

// conav-study: compares the methods with simulated operators.

int main(int argc, char** argv) {
  const auto is_supervision = [](const char* word) {
    return std::string_view(word) == "--supervision";
  };
  if (std::any_of(argv + 1, argv + argc, is_supervision)) {
    return conav::study::SupervisionMain(argc, argv);
  }
  CLI::App app(kAbout, "conav study");
  conav::study::StudyOptions options;
  AddOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  conav::log::SetService("study");
  conav::log::SetMinimumLevel(conav::log::Level::kError);
  conav::InstallStopSignals();
  return conav::study::RunStudy(options, conav::study::DescribeRun(argc, argv),
                                conav::ProcessStopToken());
}
