#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/bus/backend.h"
#include "common/bus/participant.h"
#include "common/bus/publisher.h"
#include "common/runtime/clock.h"
#include "common/runtime/config.h"
#include "common/runtime/log.h"
#include "common/runtime/threads.h"
#include "common/service/diagnostics.h"
#include "common/service/health_endpoint.h"
#include "common/service/node_services.h"

namespace conav {

/// Publishes the log of the process on /rosout while it lives, for `ros2 topic echo /rosout` and
/// rqt_console; levels and names as in rclcpp. One per process.
///
/// A DDS vendor's own thread may log a line but must not send one, so this object sends from a
/// thread of its own. When the bus cannot keep up, the oldest lines are left out, and the next line
/// sent states how many.
class Rosout {
 public:
  /// Most lines that wait to be sent.
  static constexpr std::size_t kQueueLimit = 1000;
  static constexpr std::chrono::milliseconds kDrainLimit{500};

  /// Sends one line; false when the bus did not take it.
  using Send = std::function<bool(const rcl_interfaces::msg::Log&)>;

  explicit Rosout(bus::Participant& participant);
  /// The same with any way of sending, under the name `node_name`.
  Rosout(std::string node_name, Send send);
  /// Sends what waits; stops at the first failure or after kDrainLimit. Then waits up to
  /// kDrainLimit for the last lines to arrive.
  ~Rosout();
  Rosout(const Rosout&) = delete;
  Rosout& operator=(const Rosout&) = delete;

 private:
  void Take(const log::Record& record);
  void Run();

  const std::string node_name_;
  const Send send_;
  std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::deque<rcl_interfaces::msg::Log> queue_;
  std::uint64_t left_out_ = 0;
  bool stopping_ = false;
  std::chrono::steady_clock::time_point drain_until_{};  // set when stopping
  std::thread sender_;
};

/// While it lives, freed memory goes back to the system: large blocks at once, free pages of glibc's
/// arenas each `period` and not before. By default glibc keeps both, and small blocks that live long
/// come to lie in them: each arena grows to its thread's largest moment.
class FreedMemory {
 public:
  /// Threads: one of its own.
  explicit FreedMemory(std::chrono::milliseconds period = std::chrono::minutes(1));

 private:
  std::jthread thread_;
};

/// Freed blocks of up to 32 MiB stay with the process from now on: for a renderer, which takes and
/// frees tens of MB for each picture, and would fetch them from the system again.
void KeepFreedMemory();

/// What a service's command line names; `search` is empty where it may not name one.
struct ServiceArguments {
  std::string config;
  std::string search;
  bool insecure = false;
  std::optional<bus::RosDistribution> ros;
  std::string health;  // where HealthEndpoint listens; empty = nowhere
};

/// Parses it; exits with 0 for --help and 2 for wrong usage.
ServiceArguments ParseServiceArguments(const std::string& service, const std::string& description,
                                       int argc, char** argv, bool has_search, bool has_console);

/// Loads section `<service>:` of the config file, with vendor, domain and interface resolved from
/// file and environment. Its role in the keystore is its name, or Config::kRole. Throws StartupError: file, key, value and limit.
template <class Config>
Config LoadConfig(const std::string& file, const std::string& service) {
  Config config;
  ReadConfig(LoadParameters(file, service), file + ": " + service, config);
  config.bus.role = service;
  if constexpr (requires { Config::kRole; }) config.bus.role = Config::kRole;
  config.bus = bus::Resolve(config.bus);
  return config;
}

/// Sets live parameters of a service that has Reconfigure(Config), which any thread may call; null for
/// others.
template <class Config, class Service>
Parameters::Apply ApplyTo(Service& instance, const Config& config) {
  if constexpr (requires { instance.Reconfigure(config); }) {
    return [&instance, current = config](const Parameters::Values& values) mutable -> Result<void> {
      YAML::Node node = Emitted(current);
      MergeInto(node, values);
      Config changed;
      try {
        ReadConfig(node, "parameters", changed);
      } catch (const StartupError& error) {
        return Fail(ErrorCode::kRefused, error.what());
      }
      instance.Reconfigure(changed);
      current = changed;
      return {};
    };
  } else {
    return nullptr;
  }
}

/// The body of every service's main: reads section `<service>:` of the config file, logs the
/// effective config, joins the bus as node `node_name`, sends its log to /rosout, builds the
/// service and runs it until SIGINT or SIGTERM. Where the ROS 2 distribution is known, it answers as a
/// node (NodeServices). `Service` is built from (participant, config,
/// clock) and has Run(const StopToken&). Returns the exit code: 0, or 1 after an exception, which
/// it prints. --ros comes before the file's bus.ros_distribution. With `use_search` the command
/// line may have --search, whose value that puts into the configuration; it throws StartupError.
/// Freed memory goes back to the system, or stays where Config::kKeepsFreedMemory.
template <class Config, class Service>
int RunServiceMain(const std::string& service, const std::string& description, int argc,
                   char** argv,
                   const std::function<std::string(const Config&)>& node_name = nullptr,
                   const std::function<void(Config&, const std::string&)>& use_search = nullptr) {
  constexpr bool kHasConsole = requires(Config c) { c.console.insecure; };
  const ServiceArguments arguments =
      ParseServiceArguments(service, description, argc, argv, use_search != nullptr, kHasConsole);
  std::optional<FreedMemory> freed_memory;
  if constexpr (requires { requires Config::kKeepsFreedMemory; }) {
    KeepFreedMemory();
  } else {
    freed_memory.emplace();
  }
  log::SetService(service);
  InstallStopSignals();
  try {
    auto config = LoadConfig<Config>(arguments.config, service);
    const ConfigOrigins origins{LoadParameters(arguments.config, service), Emitted(config),
                                "environment, command line or chosen at the start"};
    if (arguments.ros) config.bus.ros_distribution = arguments.ros;
    if constexpr (kHasConsole) config.console.insecure |= arguments.insecure;
    if (!arguments.search.empty()) use_search(config, arguments.search);
    std::fputs(DumpConfig(service, config, origins).c_str(), stderr);
    const SteadyClock clock;
    bus::Participant participant(node_name ? node_name(config) : service, config.bus);
    const Rosout rosout(participant);
    std::optional<NodeServices> node_services;
    if (config.bus.ros_distribution != bus::RosDistribution::kNone) {
      node_services.emplace(participant, ParametersOf(config));
    }
    std::optional<HealthEndpoint> health;
    if (!arguments.health.empty()) health.emplace(participant, clock, arguments.health);
    Service instance(participant, config, clock);
    std::optional<NodeServices::Running> runs;
    if (node_services) runs.emplace(*node_services, ApplyTo(instance, config));
    LOG_INFO("running", "node", participant.node_name(), "dds", participant.vendor());
    NotifySystemd("READY=1");
    instance.Run(ProcessStopToken());
    NotifySystemd("STOPPING=1");
    LOG_INFO("stopped");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "conav-%s: %s\n", service.c_str(), error.what());
    return 1;
  }
  return 0;
}

}  // namespace conav
