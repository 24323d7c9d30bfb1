#include "common/service/service_main.h"

#include <fmt/core.h>
#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>
#include <utility>

#include "common/bus/ros_graph.h"
#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "common/service/diagnostics.h"

namespace conav {
namespace {

/// Constants of rcl_interfaces/msg/Log: DEBUG = 10, INFO = 20, WARN = 30, ERROR = 40.
std::uint8_t RosLevel(log::Level level) {
  return static_cast<std::uint8_t>(10 * (static_cast<int>(level) + 1));
}

/// The publisher's history ends with it, so it waits until all subscribers have every line.
struct LogPublisher {
  explicit LogPublisher(bus::Participant& participant) : topic(participant, bus::kRosout) {}
  ~LogPublisher() { topic.WaitForAcknowledgments(Rosout::kDrainLimit); }

  bus::Publisher<rcl_interfaces::msg::Log> topic;
};

}  // namespace

Rosout::Rosout(bus::Participant& participant)
    : Rosout(bus::RosName(participant.node_name()),
             [publisher = std::make_shared<LogPublisher>(participant)](
                 const rcl_interfaces::msg::Log& line) {
               return publisher->topic.Publish(line).has_value();
             }) {}

Rosout::Rosout(std::string node_name, Send send)
    : node_name_(std::move(node_name)), send_(std::move(send)) {
  sender_ = std::thread([this] { Run(); });
  log::SetSink([this](const log::Record& record) { Take(record); });
}

Rosout::~Rosout() {
  log::SetSink(nullptr);
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    drain_until_ = std::chrono::steady_clock::now() + kDrainLimit;
  }
  changed_.notify_one();
  sender_.join();
}

void Rosout::Take(const log::Record& record) {
  rcl_interfaces::msg::Log line;
  line.stamp(RosWallTime(record.time));
  line.level(RosLevel(record.level));
  line.name(node_name_);
  line.msg(std::string(record.text));
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= kQueueLimit) {
      queue_.pop_front();
      ++left_out_;
    }
    queue_.push_back(std::move(line));
  }
  changed_.notify_one();
}

void Rosout::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) return;
    rcl_interfaces::msg::Log line = std::move(queue_.front());
    queue_.pop_front();
    const std::uint64_t left_out = std::exchange(left_out_, 0);
    lock.unlock();
    if (left_out > 0) line.msg(fmt::format("({} lines left out) {}", left_out, line.msg()));
    // A lost line is on stderr anyway; logging the failure would create another line.
    const bool sent = send_(line);
    lock.lock();
    if (stopping_ && (!sent || std::chrono::steady_clock::now() > drain_until_)) return;
  }
}

FreedMemory::FreedMemory(std::chrono::milliseconds period) {
  constexpr int kLargeBytes = 1024 * 1024;  // 128 KiB costs a search a tenth more processor time
  mallopt(M_MMAP_THRESHOLD, kLargeBytes);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  thread_ = std::jthread([period](const std::stop_token& stop) {
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any stopped;
    while (!stopped.wait_for(lock, stop, period, [&] { return stop.stop_requested(); })) {
      malloc_trim(0);
    }
  });
}

void KeepFreedMemory() {
  constexpr int kLargestAllowedBytes = 32 * 1024 * 1024;  // DEFAULT_MMAP_THRESHOLD_MAX of glibc
  mallopt(M_MMAP_THRESHOLD, kLargestAllowedBytes);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
}

ServiceArguments ParseServiceArguments(const std::string& service, const std::string& description,
                                       int argc, char** argv, bool has_search, bool has_console) {
  std::string name = service;
  std::ranges::replace(name, '_', '-');
  CLI::App app{description + "\nRuns until SIGINT or SIGTERM; logs to stderr.", "conav up " + name};
  ServiceArguments arguments;
  app.add_option(
         "--config", arguments.config,
         "YAML file with the section '" + service +
             ": ros__parameters:'; see deploy/config for an example. Unknown keys are rejected.")
      ->required()
      ->check([](const std::string& path) {
        const auto readable = CheckReadable(path);
        return readable ? "" : readable.error().text;
      });
  AddChoice(app, "--ros", arguments.ros, bus::kRosDistributions,
            "Distribution of the ROS 2 nodes that see this one by name",
            "the file's bus.ros_distribution, else ROS_DISTRO's, else none");
  app.add_option("--health", arguments.health,
                 "Port on this machine, or path of a Unix socket, that answers /livez, /readyz and "
                 "/metrics over HTTP");
  if (has_search) {
    app.add_option(
        "--search", arguments.search,
        "Instead of the file's planner.search: a preset, or a YAML file with search: {its "
        "keys}, as of conav demo --search");
  }
  if (has_console) {
    app.add_flag("--insecure", arguments.insecure,
                 "Allow tokens and commands in clear beyond this machine (console.insecure): the "
                 "network is trusted, or a proxy adds TLS");
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? 0 : 2);
  }
  return arguments;
}

}  // namespace conav
