#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>

#include "common/runtime/json.h"
#include "common/runtime/log.h"
#include "common/runtime/stop_token.h"
#include "launcher/demo.h"
#include "launcher/demo_command.h"
#include "launcher/port_check.h"
#include "launcher/table.h"

namespace conav::launcher {
namespace {

Progress::Style StyleOf(std::FILE* output) {
  return isatty(fileno(output)) != 0 ? Progress::Style::kTerminal : Progress::Style::kPlain;
}

void Tell(const DemoOptions& options, const DemoResult& result) {
  fmt::print("\n{}picture {}\n", ResultTable(result.metrics),
             (std::filesystem::path(result.outcome.run_folder) / "episode.svg").string());
  if (!options.json.empty()) {
    const auto json = OutcomeJson(options, result.outcome, result.metrics);
    if (const auto written = WriteJsonFile(options.json, json); !written) {
      throw StartupError(written.error().text);
    }
  }
  if (std::fflush(stdout) != 0) {
    throw StartupError(fmt::format("standard output: {}", std::strerror(errno)));
  }
}

/// Before anything is started or written. Where the operator service runs elsewhere nobody knows.
void CheckConsolePort(const DemoOptions& options) {
  const int port = options.console_port();
  if (port < 0 || options.run_with.contains("operator")) return;
  if (const auto free = CheckPort("--console", port); !free) {
    throw StartupError(free.error().text);
  }
}

int RunDemo(const DemoOptions& options) {
  CheckConsolePort(options);
  const SteadyClock clock;
  const auto program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  Progress progress(stdout, StyleOf(stdout), clock);
  Demo demo(options, program_folder, clock, progress);
  const DemoResult result = demo.Run(ProcessStopToken());
  Tell(options, result);
  return result.all_goals_reached() ? 0 : 1;
}

}  // namespace
}  // namespace conav::launcher

/// conav: starts the services of a demo and follows them.
int main(int argc, char** argv) {
  const auto options = conav::launcher::ParseDemoCommand(argc, argv);
  conav::log::SetService("launcher");
  conav::log::SetMinimumLevel(conav::log::Level::kWarning);
  conav::InstallStopSignals();
  try {
    return conav::launcher::RunDemo(options);
  } catch (const conav::launcher::UsageError& error) {
    std::fprintf(stderr, "conav demo: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "conav demo: %s\n", error.what());
    return 1;
  }
}
