#include <cstdio>
#include <exception>
#include <filesystem>

#include "common/runtime/log.h"
#include "common/runtime/stop_token.h"
#include "launcher/demo.h"
#include "launcher/demo_command.h"

/// conav: starts the services of a demo and follows them.
int main(int argc, char** argv) {
  const auto options = conav::launcher::ParseDemoCommand(argc, argv);
  conav::log::SetService("launcher");
  conav::log::SetMinimumLevel(conav::log::Level::kWarning);
  conav::InstallStopSignals();
  try {
    const conav::SteadyClock clock;
    const auto program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
    conav::launcher::Demo demo(options, program_folder, clock);
    return demo.Run(conav::ProcessStopToken()) ? 0 : 1;
  } catch (const conav::launcher::UsageError& error) {
    std::fprintf(stderr, "conav demo: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "conav demo: %s\n", error.what());
    return 1;
  }
}
