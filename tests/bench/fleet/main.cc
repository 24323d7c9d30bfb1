// conav-bench-fleet: what a fleet costs that drives at real time, from 1 to 128 robots.
#include <fmt/core.h>
#include <net/if.h>
#include <sched.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <vector>

#include "bench/support/bench_program.h"
#include "common/bus/subscriber.h"
#include "common/runtime/file.h"
#include "launcher/process.h"
#include "planner/explain/decision_file.h"
#include "sim/world/random_maze.h"
#include "support/loopback.h"
#include "support/temporary_folder.h"

namespace conav::bench {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr int kBarRobots = 100;
constexpr double kCoresBar = 2.0;
constexpr double kDecisionBarMs = 200.0;
constexpr double kDecisionsBar = 3.0;  // for each move

struct Options {
  std::vector<int> robots{1, 8, 32, 100};
  double seconds = 30.0;
  double warm_up_s = 15.0;  // after the first moves: all decide at once then
  std::uint64_t seed = 1;
  std::string perception = "embedded";
  std::string vendor{Name(bus::kDefaultVendor)};
  bool check = false;
};

/// The side of the maze for so many robots, walls included: four share the area of the usual maze of 13 x 13
/// cells, of which a little over half is free. Chosen before anything was measured.
int SideFor(int robots) {
  constexpr int kUsual = 13;
  int side = kUsual;
  while (4 * side * side < kUsual * kUsual * robots) side += 2;  // sides are odd
  return side;
}

/// A random maze with as many rooms for its area as the usual one, as a map_server file. Returns that.
fs::path WriteMap(int robots, std::uint64_t seed, const fs::path& folder) {
  sim::RandomMazeOptions options;
  options.height = options.width = SideFor(robots);
  options.max_rooms = options.max_rooms * options.width * options.width / (13 * 13);
  options.retry_count *= options.max_rooms;
  const sim::Maze maze = sim::GenerateMaze(options, seed, 1);
  std::string pixels = fmt::format("P2\n{} {}\n255\n", options.width, options.height);
  for (const char cell : maze.entities.values()) pixels += cell == sim::kMazeWall ? "0\n" : "254\n";
  const fs::path file = folder / "maze.yaml";
  const auto written = WriteFile(folder / "maze.pgm", pixels).and_then([&] {
    return WriteFile(file,
                     "image: maze.pgm\nresolution: 2.0\norigin: [0, 0, 0]\nnegate: 0\n"
                     "occupied_thresh: 0.65\nfree_thresh: 0.196\n");
  });
  if (!written) throw StartupError(written.error().text);
  return file;
}

/// Moves this process and its children into a network namespace of its own, whose loopback interface carries
/// nothing else. False without the right to.
bool EnterOwnNetwork() {
  if (unshare(CLONE_NEWNET) != 0) return false;
  const int any_socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP;
  const bool up = ioctl(any_socket, SIOCSIFFLAGS, &request) == 0;
  close(any_socket);
  if (!up) throw StartupError("the loopback interface of an own network does not start");
  return true;
}

/// Bytes that the loopback interface has carried.
double LoopbackBytes() {
  std::ifstream file("/proc/self/net/dev");
  for (std::string line; std::getline(file, line);) {
    const auto name = line.find("lo:");
    if (name != std::string::npos) return std::stod(line.substr(name + 3));
  }
  return 0.0;
}

/// What a program has used, all its processes together.
struct Usage {
  double cpu_s = 0.0;
  double memory_mb = 0.0;  // resident
};
using Usages = std::map<std::string, Usage>;

Usage UsageOf(pid_t pid) {
  Usage usage;
  std::string text;
  std::getline(std::ifstream(fmt::format("/proc/{}/stat", pid)), text);
  const auto name_end = text.rfind(") ");
  if (name_end == std::string::npos) return usage;  // it has ended
  std::istringstream words(text.substr(name_end + 2));
  std::string skipped;
  for (int i = 0; i < 11; ++i) words >> skipped;  // utime and stime are the 14th and 15th of all
  double user = 0.0;
  double system = 0.0;
  words >> user >> system;
  usage.cpu_s = (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
  std::ifstream status(fmt::format("/proc/{}/status", pid));
  for (std::string word; status >> word;) {
    if (word == "VmRSS:") status >> usage.memory_mb;  // kB
  }
  usage.memory_mb /= 1024.0;
  return usage;
}

/// Of the launcher and the services that it has started, by program.
Usages UsagesOf(pid_t launcher) {
  Usages usages;
  const auto add = [&](pid_t pid) {
    std::error_code gone;
    const fs::path program = fs::read_symlink(fmt::format("/proc/{}/exe", pid), gone);
    if (gone) return;
    const Usage one = UsageOf(pid);
    Usage& sum = usages[program.filename().string()];
    sum.cpu_s += one.cpu_s;
    sum.memory_mb += one.memory_mb;
  };
  add(launcher);
  std::ifstream children(fmt::format("/proc/{0}/task/{0}/children", launcher));
  for (pid_t pid = 0; children >> pid;) add(pid);
  return usages;
}

/// One demo, and what the planner says of itself.
class Fleet {
 public:
  Fleet(const Options& options, int robots, const fs::path& folder)
      : domain_(test::LeaseDomain()),
        result_(folder / "result.json"),
        participant_("bench_fleet", test::OnLoopback(options.vendor, domain_.domain())),
        reports_(participant_, bus::kDiagnostics),
        demo_("conav demo", Command(options, robots, domain_.domain(), folder),
              folder / "demo.log"),
        folder_(folder) {}

  pid_t pid() const { return demo_.pid(); }

  /// Until each robot has decided once. Throws StartupError when the demo ends, or takes too long.
  void WaitForFirstDecisions(int robots) {
    const auto end = steady_clock::now() + kStartLimit;
    while (decisions_ < robots) {
      Receive();
      if (steady_clock::now() > end) throw StartupError(WithLog("the robots do not decide:"));
    }
  }
  void RunFor(double seconds) {
    const auto end = steady_clock::now() + std::chrono::duration<double>(seconds);
    while (steady_clock::now() < end) Receive();
  }
  /// Of the planner since its start, those to wait included, as last reported.
  double decisions() const { return decisions_; }
  double simulation_time_s() const { return simulation_time_s_; }
  /// Ends it. Its result, as `conav demo --json` writes it.
  Json End() {
    demo_.Signal(SIGINT);
    const auto end = steady_clock::now() + kEndLimit;
    while (!demo_.Poll()) {
      if (steady_clock::now() > end) throw StartupError(WithLog("the demo does not end:"));
      participant_.Wait(kLook);
    }
    const auto text = ReadFile(result_);
    if (!text) throw StartupError(WithLog(text.error().text));
    return Json::parse(*text);
  }
  /// Wall time of each search that began in this while of simulation time, in ms.
  std::vector<double> DecisionTimes(double from_s, double to_s) const {
    std::vector<double> times;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (!entry.path().filename().string().starts_with("decisions")) continue;
      const auto read = planner::ReadDecisions(entry.path(), [&](planner::DecisionRecord&& one) {
        const double at_s = one.report.stamp.ToSeconds();
        // A step aside takes no search.
        if (at_s >= from_s && at_s < to_s && one.report.duration_ms > 0.0)
          times.push_back(one.report.duration_ms);
      });
      if (!read) throw StartupError(read.error().text);
    }
    return times;
  }

 private:
  static constexpr std::chrono::milliseconds kLook{100};
  static constexpr std::chrono::minutes kStartLimit{3};
  static constexpr std::chrono::minutes kEndLimit{1};

  void Receive() {
    participant_.Wait(kLook);
    for (const auto& array : reports_.Take()) {
      for (const auto& status : array.status()) {
        for (const auto& pair : status.values()) {
          if (pair.key() == "decisions") decisions_ = std::stod(pair.value());
          if (pair.key() == "simulation_time_s") simulation_time_s_ = std::stod(pair.value());
        }
      }
    }
    if (demo_.Poll()) throw StartupError(WithLog("the demo has ended:"));
  }
  static std::vector<std::string> Command(const Options& options, int robots, int domain,
                                          const fs::path& folder) {
    const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "conav";
    std::vector<std::string> words{program.string(), "demo", "--headless"};
    const auto add = [&](const char* option, std::string value) {
      words.emplace_back(option);
      words.push_back(std::move(value));
    };
    add("--console", "0");  // nobody opens its page
    add("--speed", "1");
    add("--camera", "none");
    add("--robots", std::to_string(robots));
    add("--map", WriteMap(robots, options.seed, folder).string());
    add("--seed", std::to_string(options.seed));
    add("--perception", options.perception);
    add("--dds", options.vendor);
    add("--domain", std::to_string(domain));
    add("--out", (folder / "runs").string());
    add("--json", (folder / "result.json").string());
    return words;
  }

  std::string WithLog(std::string what) const {
    for (const std::string& line : launcher::LastLines(demo_.log(), 5)) what += "\n" + line;
    return what;
  }

  launcher::DomainLease domain_;
  fs::path result_;
  bus::Participant participant_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> reports_;
  launcher::Process demo_;
  fs::path folder_;
  double decisions_ = 0.0;
  double simulation_time_s_ = 0.0;
};

/// Adds the figures of one fleet to `metrics`, as robots<N>_... Returns them with those of each program.
Json MeasureFleet(const Options& options, int robots, Rounds& metrics) {
  const test::TemporaryFolder folder;
  Fleet fleet(options, robots, folder.path());
  fleet.WaitForFirstDecisions(robots);
  fleet.RunFor(options.warm_up_s);
  const Usages before = UsagesOf(fleet.pid());
  const double bytes_before = LoopbackBytes();
  const double from_s = fleet.simulation_time_s();
  const auto begin = steady_clock::now();
  fleet.RunFor(options.seconds);
  const double seconds = std::chrono::duration<double>(steady_clock::now() - begin).count();
  const double bytes = LoopbackBytes() - bytes_before;
  Usages usages = UsagesOf(fleet.pid());
  const double to_s = fleet.simulation_time_s();
  const double decisions = fleet.decisions();
  const Json result = fleet.End();
  double moves = 0.0;
  double time_s = 0.0;
  for (const Json& robot : result["robots"]) {
    moves += robot["cell_moves"].get<double>();
    time_s = std::max(time_s, robot["time_s"].get<double>());
  }
  const std::vector<double> times = fleet.DecisionTimes(from_s, to_s);
  Usage all;
  Json programs = Json::object();
  for (auto& [name, usage] : usages) {
    const auto earlier = before.find(name);
    const double cores =
        (usage.cpu_s - (earlier == before.end() ? 0.0 : earlier->second.cpu_s)) / seconds;
    programs[name] = {{"cores", cores}, {"memory_mb", usage.memory_mb}};
    all.cpu_s += cores;
    all.memory_mb += usage.memory_mb;
  }
  Json figures{{"cores", all.cpu_s},
               {"memory_mb", all.memory_mb},
               {"decision_p50_ms", Quantile(times, 0.5)},
               {"decision_p99_ms", Quantile(times, 0.99)},
               {"decisions_per_move", moves > 0.0 ? decisions / moves : 0.0},
               {"moves_per_s", time_s > 0.0 ? moves / time_s : 0.0},
               {"bytes_per_s", bytes / seconds}};
  for (const auto& [name, value] : figures.items()) {
    metrics.Add({{fmt::format("robots{}_{}", robots, name), value.get<double>()}});
  }
  figures["programs"] = std::move(programs);
  return figures;
}

void PrintFleet(int robots, const Json& figures) {
  const auto of = [&](const char* name) { return figures[name].get<double>(); };
  fmt::print(
      "{:>3} robots, maze of {} x {}: {:.2f} cores, {:.0f} MB; decisions p50 {:.1f}, p99 {:.1f} "
      "ms, "
      "{:.2f} a move; {:.1f} moves/s; {:.0f} kB/s\n",
      robots, SideFor(robots), SideFor(robots), of("cores"), of("memory_mb"), of("decision_p50_ms"),
      of("decision_p99_ms"), of("decisions_per_move"), of("moves_per_s"),
      of("bytes_per_s") / 1000.0);
  for (const auto& [name, one] : figures["programs"].items()) {
    fmt::print("      {:<26} {:6.3f} cores {:7.0f} MB\n", name, one["cores"].get<double>(),
               one["memory_mb"].get<double>());
  }
  std::fflush(stdout);
}

/// Prints each bar. Throws std::runtime_error when one is missed, or was not measured.
void CheckBars(const Rounds& metrics) {
  int missed = 0;
  for (const auto& [name, bar] : {std::pair("cores", kCoresBar),
                                  {"decision_p99_ms", kDecisionBarMs},
                                  {"decisions_per_move", kDecisionsBar}}) {
    const std::string metric = fmt::format("robots{}_{}", kBarRobots, name);
    if (metrics.Of(metric).empty())
      throw std::runtime_error(fmt::format("--check needs {} robots", kBarRobots));
    const double value = metrics.Median(metric);
    fmt::print("{}: {:.2f}, at most {}: {}\n", metric, value, bar, value <= bar ? "met" : "MISSED");
    missed += value <= bar ? 0 : 1;
  }
  if (missed > 0) throw std::runtime_error(fmt::format("{} bars missed", missed));
}

void Measure(const BenchProgram& program, const Options& options) {
  fmt::print("{}; real time, no camera, perception {}\n", Machine(), options.perception);
  const bool alone = EnterOwnNetwork();
  if (!alone) fmt::print("without root the bytes are those of all programs on this machine\n");
  Rounds metrics;
  Json details = Json::object();
  program.ForEachRound([&] {
    for (const int robots : options.robots) {
      if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r{} robots ", robots);
      const Json figures = MeasureFleet(options, robots, metrics);
      PrintFleet(robots, figures);
      details[std::to_string(robots)].push_back(figures);
    }
  });
  program.Write({{"perception", options.perception},
                 {"seconds", options.seconds},
                 {"own_network", alone},
                 {"details", details},
                 {"metrics", metrics.Medians()}});
  if (options.check) CheckBars(metrics);
}

void AddOptions(BenchProgram& program, Options& options) {
  program.app()
      .add_option("--robots", options.robots,
                  "Sizes of the fleet, such as 1,2,4,8,16,32,64,100,128")
      ->delimiter(',')
      ->capture_default_str()
      ->check(Between(1, 128));
  program.AddNumber("--seconds", options.seconds, "Length of a measurement", 1.0, 3600.0);
  program.AddNumber("--warm-up", options.warm_up_s,
                    "s after the first decisions, which all fall together, until it begins", 0.0,
                    600.0);
  program.AddNumber("--seed", options.seed, "Of the maze, the robots and the operator", 0,
                    1'000'000);
  program.app()
      .add_option(
          "--perception", options.perception,
          "The model of the operator: in the planner (embedded), or asked of conav-nhpm (remote)")
      ->capture_default_str()
      ->check(CLI::IsMember({"embedded", "remote"}));
  program.app()
      .add_option("--dds", options.vendor, "Vendor of all services")
      ->capture_default_str()
      ->check(CLI::IsMember(conav::Names(conav::bus::kVendors)));
  program.app().add_flag("--check", options.check,
                         "Exit code 1 when a bar of 100 robots is missed");
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench fleet",
      "What a fleet costs that drives at real time without a camera: processor time and memory of "
      "each\n"
      "program, wall time of decisions, decisions for each move, bytes on the loopback interface.\n"
      "Runs `conav demo --speed 1` with its recorder, its simulated operator and a console that "
      "nobody\n"
      "opens, in a random maze in which four robots share the area of 13 x 13 cells. As root in a "
      "network\n"
      "of its own, so that the bytes are the fleet's alone. About 25 s and --seconds for each "
      "size.\n"
      "Metrics of --json: robots<N>_cores (s of processor time per s, of all programs), "
      "robots<N>_memory_mb\n"
      "(resident), robots<N>_decision_p50_ms and robots<N>_decision_p99_ms (of searches, by the "
      "clock on\n"
      "the wall: other programs on the machine make them longer), robots<N>_decisions_per_move "
      "(decisions\n"
      "of any kind, those to wait included), robots<N>_moves_per_s, robots<N>_bytes_per_s.\n"
      "Bars: 100 robots on 2 cores, p99 under 200 ms, at most 3 decisions a move.",
      1);
  Options options;
  AddOptions(program, options);
  return program.Run(argc, argv, [&] { Measure(program, options); });
}
