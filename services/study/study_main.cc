#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>
#include <vector>

#include "common/cli/cli.h"
#include "common/runtime/config.h"
#include "common/runtime/log.h"
#include "common/runtime/random.h"
#include "launcher/demo_plan.h"
#include "study/report.h"
#include "study/study_episode.h"
#include "study/study_run.h"
#include "study/supervision.h"
#include "study/supervision_report.h"

// conav-study: compares the methods, or with --supervision the orders of the attention queue, with
// simulated operators.

namespace conav::study {
namespace {

constexpr const char* kStudyProgram = "conav study";
constexpr const char* kSupervisionProgram = "conav study --supervision";

constexpr const char* kStudyAbout =
    R"(The paper's user study (section 6.2, table 3) with SIMULATED operators: every operator does
every method on every layout, each episode with all services as processes of their own over DDS. Prints,
per method, communication, steps, guidance, mapping accuracy, goals and time, the tests, and whether the
bars are met. Robots that ignore the operator (greedy) or send nothing stand beside the methods, and
teleoperation at several speeds.

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

constexpr const char* kSupervisionAbout =
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

constexpr const char* kSupervisionExitCodes =
    "Exit codes: 0 done; 1 a trial failed, interrupted or writing failed; 2 wrong usage.";

/// Options that are read as words and checked afterwards.
struct WordOptions {
  std::vector<std::string> references{"greedy", "never-send"};
  std::vector<std::string> methods;
  std::string interaction_times;
  bool is_supervision = false;
};

std::vector<std::string> ReferencesAndNone() {
  std::vector<std::string> names(kReferences.begin(), kReferences.end());
  names.emplace_back("none");
  return names;
}

void AddStudyOptions(CLI::App& app, StudyOptions& options, WordOptions& words) {
  AddShown(app, "--operators", options.design.operators, "Simulated operators");
  AddShown(app, "--layouts", options.design.layouts, "Mazes for each operator");
  words.methods = Names(options.design.methods);
  app.add_option("--methods", words.methods, "Methods of conav demo --method")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option(
         "--references", words.references,
         "More rows of the table, outside the order of methods: greedy (ignores the operator), "
         "never-send (ig-mcts without pictures), paper, paper-2000 (ig-mcts with this search), or "
         "none")
      ->delimiter(',')
      ->check(CLI::IsMember(ReferencesAndNone()))
      ->capture_default_str();
  options.design.teleop_speeds = {0.8, 1.2, 2.0};
  app.add_option(
         "--teleop-speed", options.design.teleop_speeds,
         "Forward speeds of teleop, m/s: the first in the order of methods, each other one a "
         "row; prints the speed at which teleop takes the steps of ig-mcts")
      ->delimiter(',')
      ->check(Between(0.1, 2.0))
      ->capture_default_str();
  app.add_option("--interaction-times", words.interaction_times,
                 "Assumed means of a person in seconds, for the time of the person; changes no "
                 "episode [picture=4,path=6,log_sd=0.5]");
  AddShown(app, "--robots", options.robots, "Robots per operator");
  AddSeed(app, "--seed", options.design.seed, "Seed of orders, people and random layouts");
  options.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--jobs", options.jobs, "Episodes at once [one per core]");
  AddShown(app, "--camera", options.camera, "egl renders pictures; none sends them without pixels");
  app.add_option(
      "--population", options.population,
      "Population of operators, a file like deploy/config/annotators.yaml [its careful people]");
  app.add_option("--search", options.search, "Search of ig-mcts, as of conav demo --search");
  app.add_option("--scenario", options.scenario,
                 "Task of every episode, as of conav demo --scenario");
  app.add_option("--weights", options.weights,
                 "Weights file of the perception model [the one that comes with conav]");
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_flag("--recording", options.recording, "Record each episode, like conav demo");
  app.add_flag(
      "--h264", options.h264,
      "With --camera egl: also record the streams and print their bytes as H.264 video, by "
      "ffmpeg");
  AddShown(app, "--time-limit", options.time_limit_s,
           "Time limit of an episode, seconds of wall time");
  app.add_option("--out", options.out, "Folder of the study [one in runs/, named by the design]");
  app.add_option("--json", options.json,
                 "Write the result to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.add_flag("--check", options.check, "Exit with 1 when a bar is missed");
  app.footer(kExitCodes);
}

void AddSupervisionOptions(CLI::App& app, SupervisionOptions& options, WordOptions& words) {
  app.add_flag("--supervision", words.is_supervision,
               "Run this study instead of the one of the methods");
  app.add_option("--robots", options.robots, "Numbers of robots, each 1 to 16")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--orders", options.orders, "Orders of the attention queue")
      ->delimiter(',')
      ->capture_default_str();
  words.methods = Names(options.methods);
  app.add_option("--methods", words.methods, "ig-mcts, instruction: of the worlds in turn")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--interaction-times", words.interaction_times,
                 "Means in simulation seconds, log-normal, log_sd=0 for fixed ones "
                 "[picture=4,blocked=6,path=6,log_sd=0.5]");
  AddShown(app, "--seeds", options.seeds,
           "Number of seeds, each with every number of robots and order");
  AddSeed(app, "--seed", options.seed, "The first seed");
  AddShown(app, "--minutes", options.minutes, "Simulation time of a trial");
  AddShown(app, "--goals", options.goals, "Goals of each robot; more than it can reach");
  AddShown(app, "--robots-per-world", options.robots_per_world, "Robots that share a maze");
  AddShown(app, "--answer-timeout", options.answer_timeout_s,
           "Simulation seconds after which a robot continues without an answer to its picture");
  AddShown(app, "--speed", options.speed, "Simulated seconds per second");
  AddShown(app, "--jobs", options.jobs, "Trials at once");
  app.add_option("--dds", options.dds, "cyclonedds or fastdds");
  app.add_option("--out", options.out, "Folder of the study [one in runs/, named by the design]");
  app.add_option("--json", options.json,
                 "Write the result to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.footer(kSupervisionExitCodes);
}

/// Purpose for DeriveSeed.
constexpr std::uint64_t kPeopleSeed = 4;

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

/// Everything that the results depend on, except for the program itself.
nlohmann::ordered_json DesignOf(const StudyOptions& options, const Design& design,
                                const std::vector<std::string>& people) {
  nlohmann::ordered_json episodes = nlohmann::ordered_json::array();
  for (const PlannedEpisode& episode : design.episodes) {
    episodes.push_back({{"name", episode.name}, {"seed", episode.seed}});
  }
  nlohmann::ordered_json orders = nlohmann::ordered_json::array();
  for (const auto& order : design.orders) orders.push_back(Names(order));
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const StudyRow& row : design.rows) {
    rows.push_back({{"name", row.name},
                    {"method", Name(row.method)},
                    {"communication", row.communication},
                    {"teleop_mps", row.teleop_mps},
                    {"search", row.search}});
  }
  return {{"operators", options.design.operators},
          {"layouts", design.layouts},
          {"methods", Names(design.methods)},
          {"seed", options.design.seed},
          {"robots", options.robots},
          {"camera", options.camera},
          {"search", options.search},
          {"scenario", options.scenario},
          {"h264", options.h264},
          {"dds", options.dds},
          {"weights_checksum", launcher::WeightsChecksum(BaseDemo(options))},
          {"time_limit_s", options.time_limit_s},
          {"rows", rows},
          {"orders", orders},
          {"episodes", episodes},
          {"people", people}};
}

Results Report(const StudyReport& report, const StudyOptions& options) {
  Results results{
      .text = fmt::format(
          "{}\n{} holds report.html, episodes.csv, measures/, results.json and all runs\n",
          StudyText(report), std::filesystem::absolute(options.out).string()),
      .json = StudyJson(report),
      .files = {{"episodes.csv", EpisodesCsv(report)}, {"report.html", StudyPage(report)}}};
  for (std::size_t m = 0; m < Measures().size(); ++m) {
    if (!WasMeasured(report, Measures()[m])) continue;
    results.files.emplace_back(fmt::format("measures/{}.csv", Measures()[m].key),
                               report.summary.analyses[m].csv);
  }
  results.passed = report.summary.failed.empty() &&
                   (!options.check || std::ranges::all_of(report.summary.bars, &Bar::met));
  return results;
}

/// Exit code: 0 done; 1 an episode failed, it was interrupted, a file could not be written, or a bar
/// was missed with --check; 2 wrong usage.
int RunStudy(StudyOptions options, const Provenance& provenance, const SlurmRun& slurm,
             const StopToken& stop) {
  if (const auto valid = Validate(options); !valid) {
    return Refused(kStudyProgram, valid.error().text);
  }
  const int code = CheckFiles(
      kStudyProgram, {{"--population", options.population}, {"--weights", options.weights}},
      {{"--json", options.json}});
  if (code != 0) return code;
  const Design design = MakeDesign(options.design);
  const std::vector<std::string> people = DrawPeople(options, design.subjects.size());
  const nlohmann::ordered_json document = DesignOf(options, design, people);
  if (options.out.empty()) options.out = DefaultOut(options, Fingerprint(document));
  StudyRun<EpisodeRecord> run{.program = kStudyProgram,
                              .pieces = "episodes",
                              .out = options.out,
                              .json = options.json,
                              .design = document,
                              .jobs = options.jobs,
                              .slurm = slurm};
  for (const PlannedEpisode& episode : design.episodes) run.names.push_back(episode.name);
  for (std::size_t subject = 0; subject < people.size(); ++subject) {
    run.files.emplace_back(PersonPath(design.subjects[subject]), people[subject]);
  }
  const SteadyClock clock;
  const auto programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::vector<DemoPlayer> players;
  players.reserve(static_cast<std::size_t>(options.jobs));
  for (int job = 0; job < options.jobs; ++job) players.emplace_back(programs, clock, stop);
  const launcher::DemoOptions base = BaseDemo(options);
  run.play = [&](int job, std::size_t index) {
    const PlannedEpisode& episode = design.episodes[index];
    const std::string& subject = design.subjects[static_cast<std::size_t>(episode.subject)];
    return players[static_cast<std::size_t>(job)].Play(
        episode.name, DemoFor(base, episode, subject, std::filesystem::absolute(options.out)));
  };
  run.report = [&](Records records) {
    EstimateHumanTimes(design, options.interaction, records);
    const StudySummary summary = Summarise(design, records);
    return Report({design, document, records, summary, options.camera != "none", provenance,
                   options.interaction, options.h264},
                  options);
  };
  return Run(run, stop);
}

Results Report(const SupervisionOptions& options, const std::vector<SupervisionRecord>& records,
               const ReportSection& made) {
  const SupervisionSummary summary = Summarise(options, records);
  return {.text = fmt::format(
              "{}\n{} holds report.html, supervision.svg, trials.csv, results.json and all runs\n",
              SupervisionText(options, summary), std::filesystem::absolute(options.out).string()),
          .json = SupervisionJson(options, summary),
          .files = {{"trials.csv", SupervisionCsv(records)},
                    {"supervision.svg", SupervisionPlot(options, summary)},
                    {"report.html", SupervisionPage(options, summary, made)}},
          .passed = summary.failed.empty()};
}

/// Exit code: 0 done; 1 a trial failed, it was interrupted, or a file could not be written; 2 wrong
/// usage.
int RunSupervision(SupervisionOptions options, const Provenance& provenance, const SlurmRun& slurm,
                   const StopToken& stop) {
  if (const auto valid = Validate(options); !valid) {
    return Refused(kSupervisionProgram, valid.error().text);
  }
  const int code = CheckFiles(kSupervisionProgram, {}, {{"--json", options.json}});
  if (code != 0) return code;
  const auto design = DesignOf(options);
  if (options.out.empty()) options.out = fmt::format("runs/supervision-{:.8}", Fingerprint(design));
  StudyRun<SupervisionRecord> run{.program = kSupervisionProgram,
                                  .pieces = "trials",
                                  .out = options.out,
                                  .json = options.json,
                                  .design = design,
                                  .jobs = options.jobs,
                                  .slurm = slurm};
  const std::vector<SupervisionTrial> trials = TrialsOf(options);
  for (const SupervisionTrial& trial : trials) run.names.push_back(trial.name());
  const SteadyClock clock;
  const auto programs = std::filesystem::canonical("/proc/self/exe").parent_path();
  run.play = [&](int, std::size_t index) {
    return PlayTrial(trials[index], options, programs, clock, stop);
  };
  run.report = [&](const std::map<std::string, SupervisionRecord>& all) {
    std::vector<SupervisionRecord> records;  // of this command, which may have fewer trials
    for (const std::string& name : run.names) records.push_back(all.at(name));
    return Report(options, records, ProvenanceSection(provenance, design));
  };
  return Run(run, stop);
}

int Main(int argc, char** argv) {
  const bool is_supervision = std::any_of(argv + 1, argv + argc, [](const char* word) {
    return std::string_view(word) == "--supervision";
  });
  const char* program = is_supervision ? kSupervisionProgram : kStudyProgram;
  CLI::App app(is_supervision ? kSupervisionAbout : kStudyAbout, program);
  StudyOptions study;
  SupervisionOptions supervision;
  WordOptions words;
  if (is_supervision) {
    AddSupervisionOptions(app, supervision, words);
  } else {
    AddStudyOptions(app, study, words);
  }
  SlurmRun slurm;
  AddSlurmOptions(app, slurm, argc, argv);
  if (const auto ended = Parse(app, argc, argv)) return *ended;
  const std::span<const MethodKind> allowed =
      is_supervision ? std::span<const MethodKind>(kSupervisedMethods) : kDemoMethods;
  const auto methods = ParseMethods(words.methods, allowed);
  if (!methods) return Refused(program, methods.error().text);
  const auto times = ParseInteractionTimes(words.interaction_times, supervision.interaction);
  if (!times) return Refused(program, times.error().text);
  study.design.methods = supervision.methods = *methods;
  study.interaction = supervision.interaction;
  if (!std::ranges::count(words.references, "none")) study.design.references = words.references;
  log::SetService("study");
  log::SetMinimumLevel(log::Level::kError);
  InstallStopSignals();
  const Provenance made = DescribeRun(kStudyProgram, argc, argv);
  try {
    return is_supervision ? RunSupervision(supervision, made, slurm, ProcessStopToken())
                          : RunStudy(study, made, slurm, ProcessStopToken());
  } catch (const StartupError& error) {
    return Failed(program, {ErrorCode::kInvalidArgument, error.what()});
  }
}

}  // namespace
}  // namespace conav::study

int main(int argc, char** argv) { return conav::study::Main(argc, argv); }
