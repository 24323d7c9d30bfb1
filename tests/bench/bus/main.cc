// conav-bench-bus: what our bus costs over raw use of the same vendor.
#include <fmt/core.h>

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>

#include "bench/bus/stack.h"
#include "bench/support/bench_program.h"
#include "common/bus/backend.h"
#include "common/bus/cyclone/backend.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "keystore/keystore.h"
#include "support/child_process.h"
#include "support/temporary_folder.h"
#include "support/test_messages.h"

namespace conav::bench {
namespace {

using conav_test::msg::Blob;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

class BusStack final : public Stack {
 public:
  explicit BusStack(const StackOptions& options) : participant_("bench", options.OnLoopback()) {}

  void Offer(const Channel& channel) override {
    writers_[channel.index].emplace(participant_, bus::Topic<Blob>{channel.topic, channel.qos});
  }
  void Listen(const Channel& channel, OnMessage on_message) override {
    readers_.push_back(std::make_unique<bus::Subscriber<Blob>>(
        participant_, bus::Topic<Blob>{channel.topic, channel.qos}, "",
        [on_message = std::move(on_message)](Blob&& blob) { on_message(blob.id(), &blob); }));
  }
  void Prepare(std::size_t size) override { message_.data(test::Pattern(1, size)); }
  bool Send(const Channel& channel, std::uint64_t id) override {
    message_.id(id);
    return writers_[channel.index]->Publish(message_).has_value();
  }
  void SendBack(const Channel& channel, const void* message) override {
    static_cast<void>(writers_[channel.index]->Publish(*static_cast<const Blob*>(message)));
  }

 private:
  Blob message_;
  bus::Participant participant_;
  std::array<std::optional<bus::Publisher<Blob>>, kChannels> writers_;
  std::vector<std::unique_ptr<bus::Subscriber<Blob>>> readers_;
};

std::unique_ptr<Stack> MakeStack(const StackOptions& options) {
  if (!options.raw) return std::make_unique<BusStack>(options);
  return options.vendor == Name(bus::Vendor::kFastDds) ? MakeRawFast(options)
                                                       : MakeRawCyclone(options);
}

/// The last message of a flood carries this id; the peer answers it with a pong.
constexpr std::uint64_t kEndOfFlood = ~std::uint64_t{0};

/// The other process: answers each ping with a pong of the same content, from the receive thread,
/// until its standard input ends.
void RunPeer(const StackOptions& options) {
  const auto stack = MakeStack(options);
  stack->Offer(kPong);
  stack->Listen(kPing, [&](std::uint64_t, const void* ping) { stack->SendBack(kPong, ping); });
  stack->Listen(kFlood, [&](std::uint64_t id, const void* message) {
    if (id == kEndOfFlood) stack->SendBack(kPong, message);
  });
  while (std::getchar() != EOF) {
  }
}

constexpr milliseconds kPatience{10'000};

struct RoundTrips {
  double p50_us = 0.0;
  double p99_us = 0.0;
};

/// One stack with its peer process, ready to be measured again and again.
class Traffic {
 public:
  /// Starts the peer and waits until both sides know of each other. Throws std::runtime_error.
  explicit Traffic(const StackOptions& options)
      : name_(options.name()),
        peer_(fmt::format("exec '{}' --peer {} --domain {}{}{}",
                          std::filesystem::read_symlink("/proc/self/exe").string(), options.vendor,
                          options.domain_id, options.raw ? " --raw" : "",
                          options.keystore.empty() ? "" : " --keystore " + options.keystore)),
        stack_(MakeStack(options)) {
    stack_->Offer(kPing);
    stack_->Offer(kFlood);
    stack_->Listen(kPong, [this](std::uint64_t id, const void*) { OnPong(id); });
    Connect();
  }
  ~Traffic() {
    stack_.reset();
    peer_.Wait();
  }

  /// `count` round trips, one at a time, each started by the callback of the one before.
  /// Throws std::runtime_error when an answer is missing.
  RoundTrips MeasureRoundTrips(std::size_t size, std::uint64_t count) {
    stack_->Prepare(size);
    times_us_.clear();
    times_us_.reserve(count);
    last_id_ = next_id_ + count + 1;
    const std::uint64_t last = last_id_;
    sent_at_ = steady_clock::now();
    stack_->Send(kPing, ++next_id_);
    if (!WaitFor(last, kPatience)) Fail("a message was lost");
    last_id_ = 0;
    std::sort(times_us_.begin(), times_us_.end());
    const auto at = [&](double share) {
      return times_us_[static_cast<std::size_t>(share * static_cast<double>(times_us_.size() - 1))];
    };
    return {at(0.5), at(0.99)};
  }

  /// Messages per second over `count` messages sent without waiting, until the last has arrived.
  double MeasureRate(std::size_t size, std::uint64_t count) {
    stack_->Prepare(size);
    const auto start = steady_clock::now();
    for (std::uint64_t i = 1; i <= count; ++i) {
      while (!stack_->Send(kFlood, i < count ? i : kEndOfFlood)) {
        if (steady_clock::now() - start > kPatience) Fail("stuck");
      }
    }
    if (!WaitFor(kEndOfFlood, kPatience)) Fail("the flood's end is lost");
    const std::chrono::duration<double> elapsed = steady_clock::now() - start;
    const std::lock_guard lock(mutex_);
    answered_ = 0;
    return static_cast<double>(count) / elapsed.count();
  }

 private:
  [[noreturn]] void Fail(const char* why) const { throw std::runtime_error(name_ + ": " + why); }

  void OnPong(std::uint64_t id) {
    if (id == next_id_ && id < last_id_) {
      const auto now = steady_clock::now();
      times_us_.push_back(std::chrono::duration<double, std::micro>(now - sent_at_).count());
      sent_at_ = now;
      stack_->Send(kPing, ++next_id_);
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      answered_ = id;
    }
    answer_.notify_one();
  }

  void Connect() {
    const auto start = steady_clock::now();
    std::optional<steady_clock::time_point> first_answer;
    stack_->Prepare(64);
    for (;;) {
      const std::uint64_t id = ++next_id_;
      stack_->Send(kPing, id);
      const bool answered = WaitFor(id, milliseconds(20));
      const auto now = steady_clock::now();
      if (answered && !first_answer) first_answer = now;
      if (answered && now - *first_answer > milliseconds(500)) return;
      if (now - start > kPatience) Fail("the peer does not answer");
    }
  }

  bool WaitFor(std::uint64_t id, milliseconds timeout) {
    std::unique_lock lock(mutex_);
    return answer_.wait_for(lock, timeout, [&] { return answered_ == id; });
  }

  const std::string name_;
  // Set before the first ping of a measurement, then changed by the receive thread alone; late
  // answers from before may look at the first two at any time.
  std::atomic<std::uint64_t> next_id_ = 1;
  std::atomic<std::uint64_t> last_id_ = 0;
  steady_clock::time_point sent_at_;
  std::vector<double> times_us_;

  std::mutex mutex_;  // guards answered_
  std::condition_variable answer_;
  std::uint64_t answered_ = 0;

  test::ChildProcess peer_;
  std::unique_ptr<Stack> stack_;  // last: calls OnPong
};

/// "... 50% 3.9us 90% ..." holds the value after "50% "; the last one counts.
std::optional<double> LastValueAfter(const std::string& label, const std::string& text) {
  const auto place = text.rfind(label);
  if (place == std::string::npos) return std::nullopt;
  return std::strtod(text.c_str() + place + label.size(), nullptr);
}

/// Round trip of Cyclone's own ddsperf with the bus's configuration; its ping prints half of it,
/// which is doubled here. Nothing when ddsperf is not installed.
std::optional<RoundTrips> MeasureDdsperf(std::size_t size, int domain_id) {
  if (std::system("command -v ddsperf > /dev/null 2>&1") != 0) return std::nullopt;
  const auto options =
      StackOptions{std::string(Name(bus::kDefaultVendor)), true, domain_id, ""}.OnLoopback();
  const std::string configuration =
      bus::CycloneConfiguration(bus::ResolveNetwork(options), options.lease_s);
  setenv("CYCLONEDDS_URI", configuration.c_str(), 1);
  test::ChildProcess pong(fmt::format("exec ddsperf -i {} -D 5 pong > /dev/null", domain_id));
  test::ChildProcess ping(
      fmt::format("exec ddsperf -i {} -D 3 ping size {} 2>&1 < /dev/null", domain_id, size));
  ping.Wait();
  pong.Signal(SIGTERM);
  pong.Wait();
  unsetenv("CYCLONEDDS_URI");
  const auto p50 = LastValueAfter(" 50% ", ping.text());
  const auto p99 = LastValueAfter(" 99% ", ping.text());
  if (!p50 || !p99) return std::nullopt;
  return RoundTrips{2.0 * *p50, 2.0 * *p99};
}

struct Size {
  const char* name;
  std::size_t bytes;
};
constexpr Size kSizes[] = {{"64B", 64}, {"20kB", 20'000}};

/// What is measured in turn: the bus next to the vendor's own API, or the bus with DDS security next to
/// itself without.
struct Contest {
  std::string first;  // of names of figures
  std::string second;
  std::string ratio;
  StackOptions of_first;  // but for the vendor
  StackOptions of_second;
};

/// What one vendor did at one payload size: bus_p50_us, raw_p99_us, bus_messages_per_s, ratio, ...
struct Series {
  std::string vendor;
  Size size;
  Rounds rounds;
};

void MeasureRound(const Contest& contest, Traffic& first, Traffic& second, bool is_swapped,
                  std::uint64_t trips, Series& series) {
  const std::size_t bytes = series.size.bytes;
  RoundTrips of_second;
  if (is_swapped) of_second = second.MeasureRoundTrips(bytes, trips);
  const RoundTrips of_first = first.MeasureRoundTrips(bytes, trips);
  if (!is_swapped) of_second = second.MeasureRoundTrips(bytes, trips);
  // As many messages as take a comparable time at each size.
  const std::uint64_t flood = bytes > 1000 ? trips : trips * 10;
  series.rounds.Add({{contest.first + "_p50_us", of_first.p50_us},
                     {contest.second + "_p50_us", of_second.p50_us},
                     {contest.first + "_p99_us", of_first.p99_us},
                     {contest.second + "_p99_us", of_second.p99_us},
                     {contest.first + "_messages_per_s", first.MeasureRate(bytes, flood)},
                     {contest.second + "_messages_per_s", second.MeasureRate(bytes, flood)},
                     {contest.ratio, of_first.p50_us / of_second.p50_us}});
}

/// Measures both in turn, round by round, so that they see the same machine. One Series per vendor and
/// size. Throws std::runtime_error.
std::vector<Series> RunRounds(const BenchProgram& program, std::uint64_t trips, Contest contest) {
  std::vector<Series> result;
  for (const std::string& vendor : Names(bus::kVendors)) {
    contest.of_first.vendor = contest.of_second.vendor = vendor;
    Traffic first(contest.of_first);
    Traffic second(contest.of_second);
    std::vector<Series> of_vendor;
    for (const Size& size : kSizes) of_vendor.push_back({vendor, size, {}});
    bool is_swapped = false;
    program.ForEachRound([&] {
      for (Series& series : of_vendor) {
        MeasureRound(contest, first, second, is_swapped, trips, series);
      }
      is_swapped = !is_swapped;
    });
    std::move(of_vendor.begin(), of_vendor.end(), std::back_inserter(result));
  }
  return result;
}

/// Prints a line for each series.
Json Report(const BenchProgram& program, const Contest& contest, const std::vector<Series>& all) {
  const auto& [first, second, ratio, of_first, of_second] = contest;
  fmt::print("{}, loopback, medians of {} rounds\n", Machine(), program.rounds());
  fmt::print("{:>18} {:>18} p50/p99 us {:>8} p50/p99 us   ratio  {}/{} msg/s\n", "", first, second,
             first, second);
  Json figures;
  for (const Series& series : all) {
    const auto median = [&](const std::string& name) { return series.rounds.Median(name); };
    fmt::print("{:<11} {:>5}  {:18.1f} {:8.1f}  {:8.1f} {:8.1f}  {:8.3f}  {:.0f} / {:.0f}\n",
               series.vendor, series.size.name, median(first + "_p50_us"),
               median(first + "_p99_us"), median(second + "_p50_us"), median(second + "_p99_us"),
               median(ratio), median(first + "_messages_per_s"),
               median(second + "_messages_per_s"));
    figures["metrics"][fmt::format("{}_{}_{}", series.vendor, series.size.name, ratio)] =
        median(ratio);
    Json details{{"vendor", series.vendor}, {"bytes", series.size.bytes}};
    for (const std::string& name : {first, second}) {
      for (const char* figure : {"_p50_us", "_p99_us", "_messages_per_s"}) {
        details[name + figure] = series.rounds.Of(name + figure);
      }
    }
    figures["details"].push_back(std::move(details));
  }
  return figures;
}

/// What DDS security costs, by a keystore of its own.
void CompareSecurity(const BenchProgram& program, std::uint64_t trips) {
  const auto secured = test::LeaseDomain();
  const auto clear = test::LeaseDomain();
  const test::TemporaryFolder folder;
  const std::string keystore = folder / "keystore";
  keystore::Init(keystore, 2);
  keystore::Add(keystore, {"bench", {"tools"}, {{}, {kPing.topic, kPong.topic, kFlood.topic}}}, 1);
  const Contest contest{"secured",
                        "clear",
                        "security_ratio",
                        {"", false, secured.domain(), keystore},
                        {"", false, clear.domain(), ""}};
  program.Write(Report(program, contest, RunRounds(program, trips, contest)));
}

void Compare(const BenchProgram& program, std::uint64_t trips, bool with_ddsperf) {
  const auto bus = test::LeaseDomain();
  const auto raw = test::LeaseDomain();
  const Contest contest{
      "bus", "raw", "ratio", {"", false, bus.domain(), ""}, {"", true, raw.domain(), ""}};
  Json figures = Report(program, contest, RunRounds(program, trips, contest));
  for (const Size& size : kSizes) {
    if (!with_ddsperf) break;
    const auto measured = MeasureDdsperf(size.bytes, bus.domain());
    if (!measured) continue;
    fmt::print("ddsperf     {:>5}  {:>17}  {:8.1f} {:8.1f}\n", size.name, "", measured->p50_us,
               measured->p99_us);
    figures["ddsperf"][size.name] = {{"p50_us", measured->p50_us}, {"p99_us", measured->p99_us}};
  }
  program.Write(figures);
}

}  // namespace
}  // namespace conav::bench

int main(int argc, char** argv) {
  using namespace conav::bench;
  BenchProgram program(
      "conav bench bus",
      "Round trip and throughput of the bus over raw use of the same vendor: two processes on the "
      "loopback interface, bus and raw in turn, same payload, QoS and sockets.",
      31);
  std::uint64_t trips = 1000;
  bool no_ddsperf = false;
  bool security = false;
  StackOptions peer;
  program.AddNumber("--trips", trips, "Round trips per repetition, stack and size", 10, 1000000);
  program.app().add_flag("--no-ddsperf", no_ddsperf, "Do not run ddsperf as well");
  program.app().add_flag(
      "--security", security,
      "What DDS security costs instead: the bus with it next to the bus without");
  program.app().add_option("--peer", peer.vendor,
                           "Be the other process (used by the benchmark itself)");
  program.app().add_option("--domain", peer.domain_id, "Domain of --peer");
  program.app().add_flag("--raw", peer.raw, "Stack of --peer");
  program.app().add_option("--keystore", peer.keystore, "Keys of --peer");
  return program.Run(argc, argv, [&] {
    if (security) return CompareSecurity(program, trips);
    if (peer.vendor.empty()) return Compare(program, trips, !no_ddsperf);
    RunPeer(peer);
  });
}
