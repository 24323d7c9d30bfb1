#pragma once

#include <cstdio>
#include <functional>
#include <optional>
#include <string>

#include "common/bus/backend.h"
#include "common/bus/participant.h"
#include "common/runtime/clock.h"
#include "common/runtime/config.h"
#include "common/runtime/log.h"
#include "common/runtime/threads.h"
#include "common/service/rosout.h"

namespace conav {

/// Parses `--config` of a service's command line; exits with 0 for --help and 2 for wrong usage.
std::string ParseConfigFlag(const std::string& service, const std::string& description, int argc,
                            char** argv);

/// Loads section `<service>:` of the config file, with vendor, domain and interface resolved from
/// file and environment. Throws StartupError: file, key, value and limit.
template <class Config>
Config LoadConfig(const std::string& file, const std::string& service) {
  Config config;
  ReadConfig(LoadParameters(file, service), file + ": " + service, config);
  config.bus = bus::Resolve(config.bus);
  return config;
}

/// The body of every service's main: reads section `<service>:` of the config file, logs the
/// effective config, joins the bus as node `node_name`, sends its log to /rosout, builds the
/// service and runs it until SIGINT or SIGTERM. `Service` is built from (participant, config,
/// clock) and has Run(const StopToken&). Returns the exit code: 0, or 1 after an exception, which
/// it prints.
template <class Config, class Service>
int RunServiceMain(const std::string& service, const std::string& description, int argc,
                   char** argv,
                   const std::function<std::string(const Config&)>& node_name = nullptr) {
  const std::string file = ParseConfigFlag(service, description, argc, argv);
  log::SetService(service);
  InstallStopSignals();
  try {
    const auto config = LoadConfig<Config>(file, service);
    std::fputs(DumpConfig(service, config, ConfigReader::Secrets::kKept).c_str(), stderr);
    const SteadyClock clock;
    bus::Participant participant(node_name ? node_name(config) : service, config.bus);
    const Rosout rosout(participant);
    Service instance(participant, config, clock);
    LOG_INFO("running", "node", participant.node_name(), "dds", participant.vendor());
    instance.Run(ProcessStopToken());
    LOG_INFO("stopped");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "conav-%s: %s\n", service.c_str(), error.what());
    return 1;
  }
  return 0;
}

}  // namespace conav
