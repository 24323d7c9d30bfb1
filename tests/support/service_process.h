#pragma once

#include "support/running_program.h"

namespace conav::test {

/// A program of ours with a config file, next to participants of this process; its log goes to our
/// stderr. Killed with this object, and when we are killed.
class ServiceProcess : public RunningProgram {
 public:
  ServiceProcess(const std::string& program, const std::filesystem::path& config)
      : RunningProgram(program, "--config " + config.string(), "/dev/stderr") {}

  /// Sends `signal` and blocks until the process has ended.
  launcher::ProcessEnd End(int signal) {
    Signal(signal);
    REQUIRE(Ends(std::chrono::minutes(1)));
    return Wait();
  }
};

}  // namespace conav::test
