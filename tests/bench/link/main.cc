// conav-bench-link: what a run costs on the links between robots, planner and operator.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <regex>
#include <vector>

#include "bench/link/wire_account.h"
#include "bench/support/bench_program.h"
#include "common/bus/participant.h"
#include "common/bus/topics.h"
#include "common/runtime/result.h"
#include "support/child_process.h"
#include "support/network_hosts.h"
#include "support/temporary_folder.h"

namespace conav::bench {
namespace {

using std::chrono::steady_clock;
using test::NetworkHosts;

enum Host { kRobotHost, kPlannerHost, kOperatorHost };
constexpr const char* kHosts[] = {"robots", "planner", "operator"};

struct Options {
  std::vector<int> robots{4, 16};
  std::uint64_t seed = 7;
  double speed = 1.0;
  std::string vendor{Name(bus::kDefaultVendor)};
  bool check = false;
};

// docs/reliability.md, beside pictures.
constexpr double kLinkBarPerRobot = 3000.0;  // bytes/s
constexpr double kLinkBarOf100 = 500'000.0;  // bytes/s, 4 Mbit/s

using Account = std::map<WireRow, std::uint64_t>;

/// Simulator and launcher on the robots' host; planner, nhpm and recorder on the second, with the
/// simulated operator, for which people have a page; the operator service on the third.
std::string DemoCommand(const NetworkHosts& hosts, const Options& options, int robots,
                        const std::filesystem::path& folder) {
  const auto conav = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "conav";
  std::string command = fmt::format(
      "exec {} '{}' demo --headless --console 0 --robots {} --seed {} --speed {} --dds {} "
      "--interface cn0 "
      "--peers {},{},{} --out '{}' 2>&1",
      hosts.RunOn(kRobotHost), conav.string(), robots, options.seed, options.speed, options.vendor,
      NetworkHosts::Address(0), NetworkHosts::Address(1), NetworkHosts::Address(2),
      folder.string());
  for (const auto& [service, host] :
       {std::pair("planner", kPlannerHost), std::pair("nhpm", kPlannerHost),
        std::pair("recorder", kPlannerHost), std::pair("simulated-operator", kPlannerHost),
        std::pair("operator", kOperatorHost)}) {
    command += fmt::format(" --run-with '{}={}'", service, hosts.RunOn(host));
  }
  return command;
}

bool IsPicture(const WireRow& row) {
  return row.topic == bus::kSnapshot.pattern || row.topic == bus::kCameraImage.pattern;
}

bool IsOfOperator(const WireRow& row) {
  return row.from == kOperatorHost || row.to == kOperatorHost;
}

template <class Where>
double Sum(const Account& account, Where&& where) {
  double sum = 0.0;
  for (const auto& [row, bytes] : account) sum += where(row) ? static_cast<double>(bytes) : 0.0;
  return sum;
}

/// A line for each topic, the most expensive first: bytes per second in each direction.
void Print(const Account& account, double seconds) {
  std::map<std::string, double> totals;
  for (const auto& [row, bytes] : account) totals[row.topic] += static_cast<double>(bytes);
  std::vector<std::pair<double, std::string>> order;
  for (const auto& [topic, bytes] : totals) order.emplace_back(bytes, topic);
  std::ranges::sort(order, std::greater());
  fmt::print("{:<34}", "bytes/s");
  for (int from = 0; from < 3; ++from) {
    for (int to = 0; to < 3; ++to)
      if (from != to) fmt::print(" {:>18}", fmt::format("{}->{}", kHosts[from], kHosts[to]));
  }
  fmt::print("\n");
  for (const auto& [total, topic] : order) {
    fmt::print("{:<34}", topic);
    for (int from = 0; from < 3; ++from) {
      for (int to = 0; to < 3; ++to) {
        if (from == to) continue;
        const auto entry = account.find({from, to, topic});
        const double bytes = entry != account.end() ? static_cast<double>(entry->second) : 0.0;
        fmt::print(" {:>18.0f}", bytes / seconds);
      }
    }
    fmt::print("\n");
  }
}

Json ToJson(const Account& account) {
  Json rows = Json::array();
  for (const auto& [row, bytes] : account) {
    rows.push_back({{"from", kHosts[row.from]},
                    {"to", kHosts[row.to]},
                    {"topic", row.topic},
                    {"bytes", bytes}});
  }
  return rows;
}

/// What an episode cost.
struct Episode {
  int robots;
  double seconds;
  double bytes;       // on all links, with the start
  double link_per_s;  // on the operator's link without pictures, from the first move on
  double link_pictures_per_s;
  Json rows;  // of the account: before the first move, and from then on
};

Episode MeasureEpisode(WireAccount& wire, const NetworkHosts& hosts, const Options& options,
                       int robots) {
  const test::TemporaryFolder folder;
  wire.Take();
  test::ChildProcess demo(DemoCommand(hosts, options, robots, folder.path()));
  const std::regex moved("moves +[1-9]");
  while (!std::regex_search(demo.text(), moved)) {
    if (!demo.ReadUntil("\n")) throw std::runtime_error("the demo ended:\n" + demo.text());
  }
  const Account start = wire.Take();
  const auto begin = steady_clock::now();
  while (demo.ReadUntil("\n")) {
  }
  const std::chrono::duration<double> elapsed = steady_clock::now() - begin;
  const Account run = wire.Take();
  if (const int code = demo.Wait(); code != 0)
    throw std::runtime_error(fmt::format("the demo ended with {}:\n{}", code, demo.text()));
  Print(run, elapsed.count());
  const auto any = [](const WireRow&) { return true; };
  const double episode = Sum(start, any) + Sum(run, any);
  const auto link = [&](bool pictures) {
    return Sum(run,
               [&](const WireRow& row) {
                 return IsOfOperator(row) && IsPicture(row) == pictures;
               }) /
           elapsed.count();
  };
  const Episode measured{robots,     elapsed.count(),
                         episode,    link(false),
                         link(true), {{"start", ToJson(start)}, {"run", ToJson(run)}}};
  fmt::print(
      "{} robots, {:.0f} s: {:.2f} MB between the hosts ({:.2f} of them before the first moves); "
      "the operator's link {:.0f} bytes/s, per robot {:.0f}, and {:.0f} of pictures\n\n",
      robots, elapsed.count(), episode * 1e-6, Sum(start, any) * 1e-6, measured.link_per_s,
      measured.link_per_s / robots, measured.link_pictures_per_s / robots);
  return measured;
}

/// The line through the smallest and the largest number of robots: what does not grow with them, and
/// what each adds.
void AddLine(const std::vector<Episode>& episodes, std::map<std::string, double>& metrics) {
  const auto [few, many] = std::ranges::minmax(episodes, {}, &Episode::robots);
  if (few.robots == many.robots) return;
  const double each = (many.link_per_s - few.link_per_s) / (many.robots - few.robots);
  const double fixed = few.link_per_s - each * few.robots;
  fmt::print(
      "the operator's link without pictures: {:.0f} bytes/s, and {:.0f} for each robot; 100 robots "
      "{:.0f} kB/s\n",
      fixed, each, (fixed + 100.0 * each) * 1e-3);
  metrics["operator_link_fixed_bytes_per_s"] = fixed;
  metrics["operator_link_bytes_per_s_each_robot_adds"] = each;
}

void Measure(const BenchProgram& program, const Options& options) {
  if (options.check && options.robots.size() < 2) {
    throw StartupError("--check needs two numbers of robots, for the line to 100");
  }
  WireAccount wire;
  const NetworkHosts hosts(
      3, NetworkHosts::Multicast::kOff,
      [&](int from, int to, std::span<const std::uint8_t> frame) { wire.Add(from, to, frame); });
  if (!hosts.problem().empty()) {
    throw StartupError("this needs network namespaces: root (NET_ADMIN, SYS_ADMIN) and iproute2; " +
                       hosts.problem());
  }
  Rounds metrics;
  Json last;
  program.ForEachRound([&] {
    std::vector<Episode> episodes;
    for (const int robots : options.robots) {
      episodes.push_back(MeasureEpisode(wire, hosts, options, robots));
    }
    const Episode& most = std::ranges::max(episodes, {}, &Episode::robots);
    std::map<std::string, double> values{
        {"operator_link_bytes_per_s_per_robot", most.link_per_s / most.robots},
        {"operator_link_picture_bytes_per_s_per_robot", most.link_pictures_per_s / most.robots},
        {"episode_bytes", most.bytes},
        {"episode_s", most.seconds}};
    AddLine(episodes, values);
    for (const auto& [name, value] : values) metrics.Add({{name, value}});
    last = most.rows;
  });
  const Json medians = metrics.Medians();
  last["metrics"] = medians;
  program.Write(last);
  const double per_robot = medians["operator_link_bytes_per_s_per_robot"];
  if (!options.check) return;
  const double fixed = medians["operator_link_fixed_bytes_per_s"];
  const double each = medians["operator_link_bytes_per_s_each_robot_adds"];
  const double of_100 = fixed + 100.0 * each;
  if (per_robot > kLinkBarPerRobot || of_100 > kLinkBarOf100) {
    throw StartupError(
        fmt::format("missed: {:.0f} bytes/s per robot (bar {:.0f}), {:.0f} for 100 robots ({:.0f})",
                    per_robot, kLinkBarPerRobot, of_100, kLinkBarOf100));
  }
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench link",
      "Bytes on the wire for each topic and direction between the hosts of robots, planner and "
      "operator (network namespaces) in an episode with the simulated operator. Needs root.",
      1);
  Options options;
  program.app()
      .add_option("--robots", options.robots, "Robots, a number or several: one episode each")
      ->delimiter(',')
      ->capture_default_str()
      ->check(conav::Between(1, 26));
  program.AddNumber("--seed", options.seed, "Of the episode", 0, 1'000'000);
  program.AddNumber("--speed", options.speed, "Simulated seconds per second", 0.0, 100.0);
  program.app()
      .add_option("--dds", options.vendor, "Vendor of all services")
      ->capture_default_str()
      ->check(CLI::IsMember(conav::Names(conav::bus::kVendors)));
  program.app().add_flag(
      "--check", options.check,
      "Exit code 1 above 3 kB/s per robot (of the most robots), or 4 Mbit/s for 100");
  return program.Run(argc, argv, [&] { Measure(program, options); });
}
