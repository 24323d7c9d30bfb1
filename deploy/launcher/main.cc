#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string_view>

#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"
#include "common/runtime/threads.h"
#include "launcher/demo.h"
#include "launcher/demo_options.h"
#include "launcher/demo_plan.h"
#include "launcher/domain_lease.h"
#include "launcher/progress.h"
#include "launcher/soak.h"

namespace conav::launcher {
namespace {

constexpr const char* kFooter = R"(
Without --headless it serves the operator's console on http://127.0.0.1:8080: the robots wait until
a user of that page guides them or hands over to the simulated operator; Ctrl-C ends.

Starts conav-recorder, conav-sim (one per world), conav-nhpm (one, several or none), conav-operator,
conav-planner (one or several) and conav-simulated-operator, follows them until every robot has
reached its goals, and leaves runs/<time>-seed<S>/ with the effective configuration, logs,
metrics.json, episode.svg (truth, the operator's map before and after, trajectories, pictures),
recording.mcap (the messages on the bus; conav bag, Foxglove), segments.pb.zst (the operator's edits
after each picture; conav dataset describe) and decisions.pb.zst (why the robots acted as they did;
conav explain).

Exit code: 0 all goals reached; 1 not (a process died, time limit, Ctrl-C); 2 wrong usage.

Examples:
  conav demo                                   two robots and the console, for you to guide them
  conav demo --headless --seed 7 --json r.json as fast as commanded, result as JSON
  conav demo --robots 4 --dds mixed            four robots in one maze, both DDS vendors
  conav demo --robots 8 --planners 2           eight robots shared by two planner processes
  conav demo --run-with sim="nice -n 10"       a command put before a service's own)";

void AddRunOptions(CLI::App& app, DemoOptions& options) {
  app.add_option("--robots", options.robots, "Robots in each world [2; headless 1]");
  AddShown(app, "--worlds", options.worlds, "Worlds, each with a simulator");
  AddSeed(app, "--seed", options.seed, "Seed of everything that is random");
  AddShown(app, "--operator", options.simulated_operator,
           "The simulated operator: careful, hasty, wrong (on purpose), silent, or the "
           "person of a file like deploy/config/simulated_operator.yaml");
  AddShown(app, "--planners", options.planners,
           "Number of conav-planner processes, which share the robots; one may die or join");
  app.add_flag("--headless", options.headless, "No console: as fast as the robots get commands");
  app.add_option("--console,--port", options.console,
                 "Port of the operator's console on this machine, 0 = any free one, -1 = none "
                 "[8080; headless -1]")
      ->check(Between(-1, 65535));
  AddNumber(app, "--foxglove", options.foxglove,
            "Port for Foxglove on this machine: open ws://127.0.0.1:PORT there; 0 = any free "
            "one, -1 = none",
            -1, 65535);
  app.add_option(
      "--speed", options.speed,
      "Simulated seconds per second, 0 = as fast as the robots get commands [2; headless 0]");
  app.add_option("--time-limit", options.time_limit_s,
                 "Give up after this many seconds [1800; with a console never]");
}

void AddMethodOptions(CLI::App& app, DemoOptions& options) {
  AddChoice(app, "--method", options.method, kDemoMethods, "Method that drives the robots");
  AddShown(app, "--communication", options.communication,
           "Policy that decides when ig-mcts sends a picture: search (the search itself), "
           "never, random, every, when_blocked, threshold");
  AddShown(app, "--x-source", options.x_source,
           "The planner's view of the operator's map: observed (the published one), "
           "estimated by the model, or none (estimated from nothing)");
  app.add_option(
      "--search", options.search,
      "Search of ig-mcts: default, paper, paper-2000 (as the paper prints, with 2000 "
      "iterations), paper-literal, building, waterway, or a YAML file with search: {keys "
      "of planner.search} [the one for the kind of world]");
  app.add_option("--mapping-value", options.mapping_value,
                 "Reward units that a corrected cell of the operator's map is worth: more pictures "
                 "and a better map, or fewer [that of the search: default 0.5, all others 1]");
}

void AddModelOptions(CLI::App& app, DemoOptions& options) {
  AddShown(app, "--perception", options.perception,
           "remote: the planner asks nhpm; embedded: it asks its own model");
  AddChoice(app, "--model", options.model, kPlannersModels,
            "Model that predicts the operator's edits", "nhpm; in open terrain encoder-decoder");
  app.add_option("--weights", options.weights,
                 "Weights file of the network [the one that comes with conav]");
  app.add_option("--person", options.person,
                 "Predict this person's edits with NAME.nhpm in --person-weights [everybody's]");
  app.add_option("--person-weights", options.person_weights,
                 "Folder of weights for single operators, from conav train --adapt");
  AddShown(app, "--nhpm-replicas", options.nhpm_replicas, "Number of conav-nhpm processes");
}

void AddWorldOptions(CLI::App& app, DemoOptions& options) {
  app.add_option(
      "--scenario", options.scenario,
      "A task of deploy/config/scenarios.yaml, for the world, the number of robots, what "
      "they know and the simulated operator; `conav maze --scenarios` lists them");
  app.add_option("--maze-seed", options.maze_seed,
                 "Seed of the world alone, such as the paper's 234, 666 and 9 [--seed]")
      ->check(WholeNumber());
  AddShown(app, "--rotation", options.rotation_deg,
           "Turns the world with everything in it: 0, 90, 180 or 270 degrees");
  AddShown(app, "--world", options.world,
           "maze; waterway: open terrain, with the search and the model for it");
  AddShown(app, "--preset", options.preset, "Maze preset; `conav maze --help` lists them");
  app.add_option("--map", options.map,
                 "Instead of a maze: ROS map_server YAML of the true plan, or a height map (PNG or "
                 "TIFF)");
  app.add_option("--operator-map", options.operator_map, "The operator's outdated plan");
  app.add_option(
      "--cell-size", options.cell_size_m,
      "Metres per cell of --map, 0.1 to 100; below 1, and on height maps, the terrain is "
      "open: robots drive anywhere [2]");
  app.add_option("--water-level", options.water_level,
                 "Height map: pixels from this value on are land [128]");
  app.add_option("--resolution", options.resolution_m, "Height map: metres per pixel [1]");
  app.add_option(
      "--teleop-speed", options.teleop_mps,
      "Forward speed under --method teleop, m/s; backward and turning scale with it, up to "
      "the motors' limits [0.8]");
  app.add_option("--radius", options.robot_radius_m, "Of the robots in open terrain, metres [0.2]");
  app.add_flag("--shared-goals", options.shared_goals,
               "One list of goals for all robots of a world");
  AddShown(app, "--camera", options.camera, "egl renders pictures; none sends them without pixels");
}

void AddSystemOptions(CLI::App& app, DemoOptions& options, std::vector<std::string>& run_with) {
  app.add_option("--dds", options.dds,
                 "cyclonedds, fastdds, mixed or SERVICE=VENDOR,... [CONAV_DDS or the default]");
  app.add_option("--domain", options.domain, "DDS domain [CONAV_DOMAIN or the first free one]");
  AddShown(app, "--interface", options.interface,
           "Network interface; \"\" leaves it to the vendor");
  app.add_option("--peers", options.peers, "Hosts to look for other participants; no multicast")
      ->delimiter(',');
  AddChoice(app, "--ros", options.ros, bus::kRosDistributions,
            "Distribution of the ROS 2 nodes that see conav's by name", "ROS_DISTRO's, else none");
  app.add_option("--run-with", run_with, "SERVICE=COMMAND: put COMMAND before that service's own")
      ->allow_extra_args(false);
  app.add_flag("!--no-recording", options.recording, "Do not write recording.mcap");
  app.add_flag("--streams", options.streams, "Also record the streamed pictures of the cameras");
  app.add_option("--json", options.json, "Also write the result to this file");
  AddShown(app, "--out", options.out, "Folder for the run folders");
}

[[noreturn]] void RefuseUse(std::string_view command, const std::string& reason) {
  fmt::print(stderr, "conav {}: {}\n", command, reason);
  std::exit(2);
}

void TakeRunWith(std::string_view command, const std::vector<std::string>& texts,
                 DemoOptions& options) {
  for (const std::string& text : texts) {
    auto entry = ParseRunWith(text);
    if (!entry) RefuseUse(command, entry.error().text);
    options.run_with.insert(*std::move(entry));
  }
}

/// Parses `conav demo ...`. Exits with 0 for --help, and with 2 and the reason on stderr for wrong
/// usage.
DemoOptions ParseDemoCommand(int argc, char** argv) {
  CLI::App app{"conav: robots explore a maze for which the operator has a wrong map", "conav"};
  app.require_subcommand(1);
  CLI::App* demo = app.add_subcommand(
      "demo", "Run the whole system, with the operator's console or a simulated operator alone");
  demo->footer(kFooter);
  DemoOptions options;
  std::vector<std::string> run_with;
  AddRunOptions(*demo, options);
  AddMethodOptions(*demo, options);
  AddModelOptions(*demo, options);
  AddWorldOptions(*demo, options);
  AddSystemOptions(*demo, options, run_with);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? 0 : 2);
  }
  if (demo->count("--robots") == 0 && options.waits_for_operator()) options.robots = 2;
  TakeRunWith("demo", run_with, options);
  const auto valid = Validate(options)
                         .and_then([&] { return CheckSearch(options); })
                         .and_then([&]() -> Result<void> {
                           const auto scenario = ScenarioOf(options);
                           if (scenario && demo->count("--robots") == 0) {
                             options.robots = scenario->robots;
                           }
                           return CheckWorlds(options);
                         })
                         .and_then([&] { return CheckWeights(options); })
                         .and_then([&] { return CheckOperator(options); });
  if (!valid) RefuseUse("demo", valid.error().text);
  return options;
}

Progress::Style StyleOf(std::FILE* output) {
  return isatty(fileno(output)) != 0 ? Progress::Style::kTerminal : Progress::Style::kPlain;
}

void Publish(const DemoOptions& options, const DemoResult& result) {
  const std::filesystem::path folder = result.outcome.run_folder;
  std::string text = "\n" + ResultTable(result.metrics);
  const std::filesystem::path picture = folder / "episode.svg";
  if (std::filesystem::exists(picture)) text += fmt::format("picture {}\n", picture.string());
  const auto printed = WriteStandardOutput(text);
  if (!options.json.empty()) {
    const auto json = OutcomeJson(options, result.outcome, result.metrics);
    if (const auto written = WriteJsonFile(options.json, json); !written) {
      throw StartupError(written.error().text);
    }
  }
  if (!printed) throw StartupError(printed.error().text);
}

constexpr const char* kSoakFooter = R"(
Two clients edit the maps against each other, a third gives robots new goals, stops and resumes them;
a page and a viewer of a camera watch. Services are killed with SIGKILL in turn, in an order from the
seed, and start again. All the time it checks that edits are linearizable, that a robot has one lease
holder, carries out no command after its expiry, and does not move while it is stopped; at the end
that the operator's database has every accepted edit.

Kills come in the first third of the time. Memory is measured in the second half, when caches are
full: MB/h by least squares over a sample each 5 s, for each process; a restart begins a new level.
Less than 20 minutes in all give no slope. One line a minute, a table at the end.

Exit code: 0 done; 1 something was violated, or the bar is missed with --check; 2 wrong usage.)";

constexpr double kBarMbPerH = 1.0;

struct SoakCommand {
  SoakOptions options;
  bool check = false;
};

SoakCommand ParseSoakCommand(int argc, char** argv) {
  CLI::App app{"conav", "conav"};
  app.require_subcommand(1);
  CLI::App* soak = app.add_subcommand(
      "soak", "Run the whole system for hours: drive, edit, stop, watch, kill; check and measure");
  soak->footer(kSoakFooter);
  SoakCommand command;
  DemoOptions& demo = command.options.demo;
  demo.robots = 16;
  demo.planners = 2;
  demo.preset = "open31";
  demo.speed = 1.0;
  AddNumber(*soak, "--hours", command.options.hours, "How long", 0.001, 10000.0);
  AddNumber(*soak, "--kill-every", command.options.kill_every_s,
            "Average seconds between two kills; 0 = none", 0.0, 1e6);
  AddShown(*soak, "--robots", demo.robots, "Robots in each world");
  AddShown(*soak, "--worlds", demo.worlds, "Worlds, each with a simulator");
  AddShown(*soak, "--planners", demo.planners, "Planner processes, which share the robots");
  AddSeed(*soak, "--seed", demo.seed, "Seed of everything that is random");
  AddChoice(*soak, "--method", demo.method, kDemoMethods, "Method that drives the robots");
  AddShown(*soak, "--preset", demo.preset, "Maze preset; `conav maze --help` lists them");
  AddShown(*soak, "--speed", *demo.speed, "Simulated seconds per second");
  AddShown(*soak, "--camera", demo.camera, "egl renders pictures; none sends them without pixels");
  std::vector<std::string> run_with;
  AddSystemOptions(*soak, demo, run_with);
  soak->add_flag("--check", command.check, "Exit with 1 when a process grows by over 1 MB/h");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? 0 : 2);
  }
  TakeRunWith("soak", run_with, demo);
  demo = DemoOf(command.options);
  const auto valid = Validate(demo).and_then([&] { return CheckWorlds(demo); });
  if (!valid) RefuseUse("soak", valid.error().text);
  return command;
}

int RunSoak(const SoakCommand& command) {
  const SteadyClock clock;
  const auto program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  Progress progress(stdout, Progress::Style::kSilent, clock);
  const DemoOptions& options = command.options.demo;
  Demo demo(options, program_folder, clock, progress);
  fmt::print("seed {}  {} robots  domain {}  run {}\n", options.seed, options.robots,
             demo.outcome().domain, demo.outcome().run_folder);
  Soak soak(command.options, demo.outcome(), clock);
  const DemoResult result =
      demo.Run(ProcessStopToken(), [&](const auto& running) { soak.Turn(running); });
  soak.Finish(result);
  const auto printed = WriteStandardOutput("\n" + soak.Table());
  if (!options.json.empty()) {
    const auto written = WriteJsonFile(options.json, soak.Json(result));
    if (!written) throw StartupError(written.error().text);
  }
  if (!printed) throw StartupError(printed.error().text);
  const bool grows = soak.WorstSlope().value_or(0.0) > kBarMbPerH;
  return soak.invariants().count() > 0 || (command.check && grows) ? 1 : 0;
}

/// Checks the ports before anything starts or is written, unless the operator service runs
/// elsewhere.
void CheckPorts(const DemoOptions& options) {
  if (options.run_with.contains("operator")) return;
  const auto check = [](const char* option, int port) {
    if (port < 0) return;
    if (const auto free = CheckPort(option, port); !free) throw StartupError(free.error().text);
  };
  check("--console", options.console_port());
  check("--foxglove", options.foxglove);
}

int RunDemo(const DemoOptions& options) {
  CheckPorts(options);
  const SteadyClock clock;
  const auto program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  Progress progress(stdout, StyleOf(stdout), clock);
  Demo demo(options, program_folder, clock, progress);
  const DemoResult result = demo.Run(ProcessStopToken());
  Publish(options, result);
  for (const std::string& reason : result.unwritten) {
    fmt::print(stderr, "conav demo: {}\n", reason);
  }
  return result.all_goals_reached() && result.unwritten.empty() ? 0 : 1;
}

}  // namespace
}  // namespace conav::launcher

/// conav: starts the services of a demo or of a soak and follows them.
int main(int argc, char** argv) {
  using namespace conav::launcher;
  const bool soaks = argc > 1 && std::string_view(argv[1]) == "soak";
  const char* name = soaks ? "soak" : "demo";
  const auto soak = soaks ? std::optional(ParseSoakCommand(argc, argv)) : std::nullopt;
  const auto demo = soaks ? std::nullopt : std::optional(ParseDemoCommand(argc, argv));
  conav::log::SetService("launcher");
  conav::log::SetMinimumLevel(conav::log::Level::kWarning);
  conav::InstallStopSignals();
  try {
    return soaks ? RunSoak(*soak) : RunDemo(*demo);
  } catch (const UsageError& error) {
    std::fprintf(stderr, "conav %s: %s\n", name, error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "conav %s: %s\n", name, error.what());
    return 1;
  }
}
