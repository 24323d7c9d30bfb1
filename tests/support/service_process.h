#pragma once

#include <sys/wait.h>

#include <filesystem>
#include <string>

#include "launcher/process.h"

namespace conav::test {

/// A program of ours with a config file, next to participants of this process; its log goes to our
/// stderr. Killed with this object, and when we are killed.
class ServiceProcess {
 public:
  ServiceProcess(const std::string& program, const std::filesystem::path& config)
      : process_(program, {std::string(CONAV_BIN_DIR) + "/" + program, "--config", config.string()},
                 "/dev/stderr") {}

  void Signal(int signal) { process_.Signal(signal); }

  /// Sends `signal` (0 = none) and blocks until the process has ended.
  launcher::ProcessEnd End(int signal) {
    process_.Signal(signal);
    siginfo_t information;
    waitid(P_PID, static_cast<id_t>(process_.pid()), &information, WEXITED | WNOWAIT);
    process_.Poll();
    return process_.end().value();
  }

 private:
  launcher::Process process_;
};

}  // namespace conav::test
