// conav-bench-loss: what arrives, and when, over a link that loses packets or is cut.
#include <fmt/core.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <sstream>
#include <utility>

#include "bench/loss/stops.h"
#include "bench/support/bench_program.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "common/runtime/result.h"
#include "support/child_process.h"
#include "support/network_hosts.h"
#include "support/test_messages.h"

namespace conav::bench {
namespace {

using conav_test::msg::Blob;
using std::chrono::milliseconds;
using std::chrono::steady_clock;
using test::NetworkHosts;

/// What goes over the link, with the QoS of the topics that it stands for.
struct Stream {
  const char* name;
  bus::Qos qos;
  milliseconds period;
  std::size_t bytes;
};
enum StreamIndex { kCommands, kPictures, kStates, kMaps };
constexpr Stream kStreams[] = {
    {"command", bus::kOperatorRequest.qos, milliseconds(33), 200},
    {"picture", bus::kSnapshot.qos, milliseconds(1000), 180'000},
    {"state", bus::kRobotState.qos, milliseconds(200), 300},
    {"map", bus::kBelief.qos, milliseconds(1000), 20'000},
};
constexpr std::size_t kStreamCount = std::size(kStreams);

std::string TopicOf(const Stream& stream) { return fmt::format("/bench/{}", stream.name); }

double SecondsBetween(std::int64_t start, std::int64_t end) {
  return static_cast<double>(end - start) * 1e-9;
}

void WaitUntil(steady_clock::time_point time) {
  const auto left = std::chrono::ceil<milliseconds>(time - steady_clock::now());
  if (left.count() > 0) poll(nullptr, 0, static_cast<int>(left.count()));
}

bool HasInput(milliseconds timeout) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return poll(&input, 1, static_cast<int>(timeout.count())) > 0;
}

/// One side of the link. The sender tries the topics until its input says for how many seconds it
/// sends: messages whose number is the time. It prints how many of each stream these were.
class Sender {
 public:
  explicit Sender(bus::Participant& participant) {
    for (const Stream& stream : kStreams) {
      publishers_.push_back(std::make_unique<bus::Publisher<Blob>>(
          participant, bus::Topic<Blob>{TopicOf(stream), stream.qos}));
    }
  }

  void Run() {
    std::string line;
    for (;;) {
      while (!HasInput(milliseconds(50))) Probe();
      if (!std::getline(std::cin, line)) return;
      SendFor(milliseconds(std::stoll(line)));
    }
  }

 private:
  void Probe() {
    for (const auto& publisher : publishers_) static_cast<void>(publisher->Publish(Blob{}));
  }
  void SendFor(milliseconds duration) {
    std::array<int, kStreamCount> sent{};
    std::array<steady_clock::time_point, kStreamCount> due;
    due.fill(steady_clock::now());
    const auto end = due[0] + duration;
    for (;;) {
      const auto next = std::ranges::min_element(due);
      if (*next >= end) break;
      WaitUntil(*next);
      const auto stream = static_cast<std::size_t>(next - due.begin());
      Blob message = test::MakeBlob(0, kStreams[stream].bytes);
      message.id(static_cast<std::uint64_t>(Now()));
      if (!publishers_[stream]->Publish(message))
        std::cerr << kStreams[stream].name << " refused\n";
      ++sent[stream];
      *next += kStreams[stream].period;
    }
    for (const auto& publisher : publishers_)
      publisher->WaitForAcknowledgments(milliseconds(10'000));
    std::cout << "sent";
    for (const int count : sent) std::cout << ' ' << count;
    std::cout << std::endl;
  }

  std::vector<std::unique_ptr<bus::Publisher<Blob>>> publishers_;
};

/// The other side: prints "ready" when each topic has delivered something, and for each line of its
/// input all messages since the last one: stream, when sent, when received. Messages that come
/// behind a newer one do not count.
class Receiver {
 public:
  explicit Receiver(bus::Participant& participant) {
    for (std::size_t stream = 0; stream < kStreamCount; ++stream) {
      subscribers_.push_back(std::make_unique<bus::Subscriber<Blob>>(
          participant, bus::Topic<Blob>{TopicOf(kStreams[stream]), kStreams[stream].qos}, "",
          [this, stream](Blob&& blob) { Receive(stream, static_cast<std::int64_t>(blob.id())); }));
    }
  }

  void Run() {
    std::string line;
    while (std::getline(std::cin, line)) {
      const std::lock_guard lock(mutex_);
      std::cout << received_.str() << "end" << std::endl;
      received_.str({});
    }
  }

 private:
  void Receive(std::size_t stream, std::int64_t sent_at) {
    const std::int64_t now = Now();
    const std::lock_guard lock(mutex_);
    if (!std::exchange(seen_[stream], true) && std::ranges::count(seen_, true) == kStreamCount) {
      std::cout << "ready" << std::endl;
    }
    if (sent_at <= newest_[stream]) return;
    newest_[stream] = sent_at;
    received_ << stream << ' ' << sent_at << ' ' << now << '\n';
  }

  std::mutex mutex_;  // guards what follows
  std::array<bool, kStreamCount> seen_{};
  std::array<std::int64_t, kStreamCount> newest_{};
  std::ostringstream received_;
  std::vector<std::unique_ptr<bus::Subscriber<Blob>>> subscribers_;  // first to end
};

void RunPeer(const std::string& role, const std::string& vendor) {
  if (role == "person") return RunPerson(vendor);
  if (role == "witness") return RunWitness(vendor);
  bus::ParticipantOptions options;
  options.vendor = bus::ParseVendor(vendor);
  options.domain_id = 1;
  options.interface = "cn0";
  options.peers = {NetworkHosts::Address(0), NetworkHosts::Address(1)};
  bus::Participant participant("bench", options);
  if (role == "sender") return Sender(participant).Run();
  Receiver(participant).Run();
}

struct Arrival {
  std::int64_t sent_at;
  std::int64_t arrived_at;
};

/// What one run sent, and what came of it.
struct Record {
  std::array<int, kStreamCount> sent{};
  std::array<std::vector<Arrival>, kStreamCount> arrivals;

  std::vector<double> LatenciesMs(StreamIndex stream) const {
    std::vector<double> result;
    for (const Arrival& arrival : arrivals[stream])
      result.push_back(SecondsBetween(arrival.sent_at, arrival.arrived_at) * 1e3);
    return result;
  }
  /// The share of a stream's messages that arrived, within `limit_ms`.
  double Delivered(StreamIndex stream, double limit_ms) const {
    const auto in_time = std::ranges::count_if(
        LatenciesMs(stream), [&](double latency_ms) { return latency_ms <= limit_ms; });
    return static_cast<double>(in_time) / std::max(1, sent[stream]);
  }
};

/// Sender and receiver of one vendor on two hosts.
class Peers {
 public:
  Peers(const NetworkHosts& hosts, const std::string& vendor)
      : receiver_(Command(hosts, 1, "receiver", vendor)),
        sender_(Command(hosts, 0, "sender", vendor)) {
    if (!receiver_.ReadUntil("ready\n")) throw std::runtime_error(vendor + ": no connection");
    receiver_.TakeText();
  }

  void Start(double seconds) { sender_.Send(std::to_string(static_cast<int>(seconds * 1000.0))); }
  /// Blocks until everything is sent and acknowledged, the latter for at most 10 s per stream.
  Record End() {
    Record record;
    if (!sender_.ReadUntil("sent ") || !sender_.ReadUntil("\n"))
      throw std::runtime_error("the sender ended");
    std::istringstream counts(sender_.TakeText().substr(std::string("sent ").size()));
    for (int& count : record.sent) counts >> count;
    receiver_.Send("report");
    if (!receiver_.ReadUntil("end\n")) throw std::runtime_error("the receiver ended");
    std::istringstream lines(receiver_.TakeText());
    std::size_t stream = 0;
    for (Arrival arrival{}; lines >> stream >> arrival.sent_at >> arrival.arrived_at;)
      record.arrivals.at(stream).push_back(arrival);
    return record;
  }

 private:
  static std::string Command(const NetworkHosts& hosts, int host, const char* role,
                             const std::string& vendor) {
    return fmt::format("exec {} '{}' --peer {} --vendor {}", hosts.RunOn(host),
                       std::filesystem::read_symlink("/proc/self/exe").string(), role, vendor);
  }

  test::ChildProcess receiver_;
  test::ChildProcess sender_;
};

struct Options {
  std::vector<int> losses{0, 10, 20, 30};
  double seconds = 60.0;
  double delay_ms = 20.0;
  double jitter_ms = 5.0;
  double cut_s = 10.0;
  int stops = 20;
  bool check = false;
};

/// docs/reliability.md: G1 to G3.
struct Bar {
  int loss_percent;
  double command_delivered;
  double command_p95_ms;
  double command_p99_ms;
  double picture_delivered_2s;
};
constexpr double kAny = 1.0e9;
constexpr Bar kBars[] = {
    {10, 1.0, 150.0, 400.0, 0.99}, {20, 0.999, 400.0, kAny, 0.0}, {30, 0.99, 1500.0, kAny, 0.0}};
constexpr double kRecoveryBar_s = 2.0;
constexpr double kStopBar_s = 0.6;

/// Prints and writes figures, and counts the missed bars.
class Report {
 public:
  void AddLoss(const std::string& vendor, int loss_percent, const Record& record) {
    const std::vector<double> latencies_ms = record.LatenciesMs(kCommands);
    const double delivered = record.Delivered(kCommands, 1e9);
    const double p95_ms = Quantile(latencies_ms, 0.95);
    const double p99_ms = Quantile(latencies_ms, 0.99);
    const double pictures = record.Delivered(kPictures, 2000.0);
    const auto is_bar = [&](const Bar& bar) { return bar.loss_percent == loss_percent; };
    const auto* bar = std::ranges::find_if(kBars, is_bar);
    const bool met = bar == std::end(kBars) ||
                     (delivered >= bar->command_delivered && p95_ms <= bar->command_p95_ms &&
                      p99_ms <= bar->command_p99_ms && pictures >= bar->picture_delivered_2s);
    fmt::print(
        "{:<11} {:>3} %   {:7.3f} %  {:5.0f} {:5.0f} {:5.0f}   {:6.1f} %  {:6.1f} %  {:5.0f}  {}\n",
        vendor, loss_percent, delivered * 100.0, Quantile(latencies_ms, 0.5), p95_ms, p99_ms,
        pictures * 100.0, record.Delivered(kPictures, 1e9) * 100.0,
        Quantile(record.LatenciesMs(kPictures), 0.95), Verdict(met));
    const std::string name = fmt::format("{}_loss{}_", vendor, loss_percent);
    metrics_.Add({{name + "command_delivered", delivered},
                  {name + "command_p95_ms", p95_ms},
                  {name + "command_p99_ms", p99_ms},
                  {name + "snapshot_delivered", record.Delivered(kPictures, 1e9)},
                  {name + "snapshot_delivered_2s", pictures}});
  }
  void AddCut(const std::string& vendor, double recovered_s, const Record& record) {
    const double pictures = record.Delivered(kPictures, 1e9);
    fmt::print(
        "{:<11}   cut   state and map are new {:.2f} s after it, {:.1f} % of all pictures {}\n",
        vendor, recovered_s, pictures * 100.0, Verdict(recovered_s <= kRecoveryBar_s));
    metrics_.Add({{vendor + "_cut_recovered_s", recovered_s},
                  {vendor + "_cut_snapshot_delivered", pictures}});
  }
  void AddStops(const std::string& vendor, const StopCase& stop_case,
                const std::vector<double>& seconds) {
    const double p95_s = Quantile(seconds, 0.95);
    const double max_s = Quantile(seconds, 1.0);
    fmt::print("{:<11} {:>6}   {} stops: last movement p50 {:.2f}, p95 {:.2f}, max {:.2f} s  {}\n",
               vendor, stop_case.name, seconds.size(), Quantile(seconds, 0.5), p95_s, max_s,
               Verdict(p95_s <= kStopBar_s));
    std::fflush(stdout);
    const std::string name = fmt::format("{}_stop_{}_", vendor, stop_case.name);
    metrics_.Add({{name + "p95_s", p95_s}, {name + "max_s", max_s}});
  }
  Json figures() const { return {{"metrics", metrics_.Medians()}}; }
  int missed() const { return missed_; }

 private:
  const char* Verdict(bool met) {
    missed_ += met ? 0 : 1;
    return met ? "met" : "MISSED";
  }

  Rounds metrics_;
  int missed_ = 0;
};

/// Cuts the link while everything is sent. Returns how long after it the newest state and the last
/// map from before the link's return took, in seconds.
double MeasureCut(NetworkHosts& hosts, Peers& peers, double cut_s, Record& record) {
  constexpr double kBefore_s = 2.0;
  constexpr double kAfter_s = 4.0;
  peers.Start(kBefore_s + cut_s + kAfter_s);
  const auto seconds = [](double value) {
    return std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(value));
  };
  const auto start = steady_clock::now();
  WaitUntil(start + seconds(kBefore_s));
  hosts.Cut(1, true);
  WaitUntil(start + seconds(kBefore_s + cut_s));
  hosts.Cut(1, false);
  const std::int64_t healed_at = Now();
  record = peers.End();
  double state_s = kAfter_s;
  for (const Arrival& arrival : record.arrivals[kStates]) {
    if (arrival.sent_at < healed_at) continue;
    state_s = SecondsBetween(healed_at, arrival.arrived_at);
    break;
  }
  double map_s = kAfter_s;
  for (const Arrival& arrival : record.arrivals[kMaps]) {
    if (arrival.arrived_at < healed_at) continue;
    map_s = SecondsBetween(healed_at, arrival.arrived_at);
    break;
  }
  return std::max(state_s, map_s);
}

void MeasureLinks(NetworkHosts& hosts, const std::string& vendor, const Options& options,
                  const test::LinkFaults& faults, Report& report) {
  for (const int loss_percent : options.losses) {
    hosts.SetFaults(faults);
    Peers peers(hosts, vendor);
    hosts.SetFaults({loss_percent / 100.0, faults.delay, faults.jitter});
    peers.Start(options.seconds);
    report.AddLoss(vendor, loss_percent, peers.End());
  }
  if (options.cut_s <= 0.0) return;
  hosts.SetFaults(faults);
  Peers peers(hosts, vendor);
  Record record;
  const double recovered_s = MeasureCut(hosts, peers, options.cut_s, record);
  report.AddCut(vendor, recovered_s, record);
}

void Measure(const BenchProgram& program, const Options& options) {
  NetworkHosts hosts(3, NetworkHosts::Multicast::kOff);
  if (!hosts.problem().empty()) {
    throw StartupError("this needs network namespaces: root (NET_ADMIN, SYS_ADMIN) and iproute2; " +
                       hosts.problem());
  }
  const auto as_time = [](double ms) {
    return std::chrono::microseconds(static_cast<std::int64_t>(ms * 1000.0));
  };
  const test::LinkFaults faults{0.0, as_time(options.delay_ms), as_time(options.jitter_ms)};
  fmt::print("{}, {} s each, {} ms +- {} ms each way\n", Machine(), options.seconds,
             options.delay_ms, options.jitter_ms);
  fmt::print("                     command p50/p95/p99 ms      picture in 2 s      all  p95 ms\n");
  Report report;
  program.ForEachRound([&] {
    for (const std::string& vendor : Names(bus::kVendors)) {
      MeasureLinks(hosts, vendor, options, faults, report);
      if (options.stops == 0) continue;
      for (const StopCase& stop_case : kStopCases) {
        report.AddStops(vendor, stop_case,
                        MeasureStops(hosts, vendor, stop_case, faults, options.stops));
      }
    }
  });
  program.Write(report.figures());
  if (options.check && report.missed() > 0)
    throw StartupError(fmt::format("{} bars are missed", report.missed()));
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench loss",
      "What arrives over a link that loses packets each way, and after one that was cut: 30 "
      "commands a second and a picture of 180 kB every second, between two network namespaces, for "
      "both DDS vendors. Then how long robots go on after STOP while the planner works, hangs, or "
      "is "
      "killed, and at 10 % loss. Needs root.",
      1);
  Options options;
  std::string peer;
  std::string vendor;
  program.app()
      .add_option("--loss", options.losses, "Percent of the packets that are lost each way")
      ->delimiter(',')
      ->capture_default_str()
      ->check(conav::Between(0, 60));
  program.AddNumber("--seconds", options.seconds, "Length of a run", 1.0, 3600.0);
  program.AddNumber("--delay-ms", options.delay_ms, "Delay each way", 0.0, 1000.0);
  program.AddNumber("--jitter-ms", options.jitter_ms, "Of the delay", 0.0, 1000.0);
  program.AddNumber("--cut", options.cut_s, "s for which the link is cut; 0 = not at all", 0.0,
                    60.0);
  program.AddNumber("--stops", options.stops, "Stopped robots in each case; 0 = none", 0, 1000);
  program.app().add_flag("--check", options.check, "Exit code 1 when a bar is missed");
  program.app().add_option("--peer", peer, "Be one side (used by the benchmark itself)");
  program.app().add_option("--vendor", vendor, "Of --peer");
  return program.Run(argc, argv, [&] {
    if (peer.empty()) return Measure(program, options);
    RunPeer(peer, vendor);
  });
}
