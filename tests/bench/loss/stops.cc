#include "bench/loss/stops.h"

#include <fmt/core.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "common/bus/subscriber.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "operator/simulated/operator_client.h"
#include "support/child_process.h"
#include "support/temporary_folder.h"
#include "support/wait.h"

namespace conav::bench {

const StopCase kStopCases[4] = {{"works", 0.0, 0, 0.0},
                                {"hung", 0.0, SIGSTOP, 0.0},
                                {"killed", 0.0, SIGKILL, 15.5},
                                {"loss10", 0.1, 0, 0.0}};

namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;
using test::NetworkHosts;

enum Host { kRobotHost, kPlannerHost, kOperatorHost };
constexpr int kRobots = 4;
constexpr int kDomain = 2;
// More than noise of the physics: below it a robot stands.
constexpr double kStandsMps = 0.01;
constexpr double kStandsRps = 0.02;
constexpr double kQuiet_s = 0.6;

using Times = std::array<std::int64_t, kRobots>;

double SecondsSince(std::int64_t time) { return static_cast<double>(Now() - time) * 1e-9; }

bus::ParticipantOptions OptionsOf(const std::string& vendor) {
  bus::ParticipantOptions options;
  options.vendor = bus::ParseVendor(vendor);
  options.domain_id = kDomain;
  options.interface = "cn0";
  for (int host = 0; host < 3; ++host) options.peers.push_back(NetworkHosts::Address(host));
  return options;
}

std::string Here() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

std::string PeerCommand(const NetworkHosts& hosts, Host host, const char* role,
                        const std::string& vendor) {
  return fmt::format("exec {} '{}' --peer {} --vendor {}", hosts.RunOn(host), Here(), role, vendor);
}

/// A demo on three hosts with a person and a witness. Robots have far to go.
class StoppedDemo {
 public:
  StoppedDemo(const NetworkHosts& hosts, const std::string& vendor)
      : output_(folder_.path() / "output.txt"),
        demo_(Command(hosts, vendor)),
        person_(PeerCommand(hosts, kOperatorHost, "person", vendor)),
        witness_(PeerCommand(hosts, kRobotHost, "witness", vendor)) {}
  ~StoppedDemo() {
    demo_.Signal(SIGINT);
    demo_.Wait();
  }
  StoppedDemo(const StoppedDemo&) = delete;
  StoppedDemo& operator=(const StoppedDemo&) = delete;

  /// Blocks until a robot moves.
  void WaitForMovement() {
    const bool moves = test::WaitUntil(
        [this] {
          const Times moved = LastMoved();
          return std::ranges::any_of(moved, [](auto time) { return SecondsSince(time) < 0.1; });
        },
        60s);
    if (!moves) throw std::runtime_error("no robot moves:\n" + Output());
  }
  /// Those of the robots that moved right before; returns the seconds until each stood.
  std::vector<double> Stop(int planner_signal) {
    const Times before = LastMoved();
    if (planner_signal != 0) kill(PlannerPid(), planner_signal);
    const std::int64_t asked = Now();
    person_.Send("stop");
    Times moved{};
    const bool all_stand = test::WaitUntil(
        [&] {
          moved = LastMoved();
          return SecondsSince(asked) > 2.0 && std::ranges::all_of(moved, [](auto time) {
                   return SecondsSince(time) > kQuiet_s;
                 });
        },
        20s);
    if (!all_stand) throw std::runtime_error("a robot moves 20 s after STOP:\n" + Output());
    std::vector<double> seconds;
    for (std::size_t robot = 0; robot < kRobots; ++robot) {
      if (asked - before[robot] > std::chrono::nanoseconds(100ms).count()) continue;
      seconds.push_back(std::max(0.0, static_cast<double>(moved[robot] - asked) * 1e-9));
    }
    return seconds;
  }
  void Resume(int planner_signal) {
    if (planner_signal == SIGSTOP) kill(PlannerPid(), SIGCONT);
    person_.Send("resume");
  }

 private:
  std::string Command(const NetworkHosts& hosts, const std::string& vendor) const {
    std::string command = fmt::format(
        "exec {} '{}' demo --headless --speed 1 --camera none --no-recording --method greedy "
        "--operator silent --preset open31 --robots {} --seed 7 --dds {} --domain {} --interface "
        "cn0 --peers {},{},{} --out '{}'",
        hosts.RunOn(kRobotHost), (std::filesystem::path(Here()).parent_path() / "conav").string(),
        kRobots, vendor, kDomain, NetworkHosts::Address(0), NetworkHosts::Address(1),
        NetworkHosts::Address(2), folder_.path().string());
    for (const auto& [service, host] :
         {std::pair("planner", kPlannerHost), std::pair("nhpm", kPlannerHost),
          std::pair("simulated-operator", kPlannerHost), std::pair("operator", kOperatorHost)}) {
      command += fmt::format(" --run-with '{}={}'", service, hosts.RunOn(host));
    }
    return command + fmt::format(" > '{}' 2>&1", output_.string());
  }
  std::string Output() const { return ReadFile(output_).value_or(""); }
  /// Of the planner's newest process.
  pid_t PlannerPid() const {
    const std::string output = Output();
    const std::string name = "started planner (pid ";  // or "restarted"
    const std::size_t found = output.rfind(name);
    if (found == std::string::npos) throw std::runtime_error("no planner:\n" + output);
    return std::stoi(output.substr(found + name.size()));
  }
  Times LastMoved() {
    witness_.Send("?");
    if (!witness_.ReadUntil("\n")) throw std::runtime_error("the witness ended");
    std::istringstream line(witness_.TakeText());
    Times times{};
    for (std::int64_t& time : times) line >> time;
    return times;
  }

  test::TemporaryFolder folder_;
  std::filesystem::path output_;
  test::ChildProcess demo_;
  test::ChildProcess person_;
  test::ChildProcess witness_;
};

}  // namespace

std::vector<double> MeasureStops(NetworkHosts& hosts, const std::string& vendor,
                                 const StopCase& stop_case, const test::LinkFaults& faults,
                                 int stops) {
  hosts.SetFaults(faults);
  StoppedDemo demo(hosts, vendor);
  demo.WaitForMovement();
  hosts.SetFaults({stop_case.loss, faults.delay, faults.jitter});
  std::vector<double> seconds;
  while (static_cast<int>(seconds.size()) < stops) {
    demo.WaitForMovement();
    const std::int64_t begin = Now();
    const std::vector<double> of_round = demo.Stop(stop_case.planner_signal);
    seconds.insert(seconds.end(), of_round.begin(), of_round.end());
    const double pause_s = stop_case.least_pause_s - SecondsSince(begin);
    if (pause_s > 0.0) poll(nullptr, 0, static_cast<int>(pause_s * 1e3));
    demo.Resume(stop_case.planner_signal);
  }
  return seconds;
}

void RunPerson(const std::string& vendor) {
  const SteadyClock clock;
  bus::Participant participant("person", OptionsOf(vendor));
  operators::OperatorClient client(participant, clock, {UniqueId()});
  for (;;) {
    participant.Wait(5ms);
    client.Poll();
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, 0) <= 0) continue;
    std::string line;
    if (!std::getline(std::cin, line)) return;
    if (line == "stop") client.Send("w1", StopRequest{{}, "bench"}, {});
    if (line == "resume") client.Send("w1", ResumeRequest{}, {});
  }
}

void RunWitness(const std::string& vendor) {
  std::array<std::atomic<std::int64_t>, kRobots> moved{};
  bus::Participant participant("witness", OptionsOf(vendor));
  std::vector<std::unique_ptr<bus::Subscriber<nav_msgs::msg::Odometry>>> odometry;
  for (int robot = 0; robot < kRobots; ++robot) {
    odometry.push_back(std::make_unique<bus::Subscriber<nav_msgs::msg::Odometry>>(
        participant, bus::kOdometry, fmt::format("r{}", robot + 1),
        [&time = moved[static_cast<std::size_t>(robot)]](nav_msgs::msg::Odometry&& message) {
          const auto& twist = message.twist().twist();
          const bool moves = std::abs(twist.linear().x()) > kStandsMps ||
                             std::abs(twist.angular().z()) > kStandsRps;
          if (moves) time = Now();
        }));
  }
  std::string line;
  while (std::getline(std::cin, line)) {
    for (const auto& time : moved) std::cout << time << ' ';
    std::cout << std::endl;
  }
}

}  // namespace conav::bench
