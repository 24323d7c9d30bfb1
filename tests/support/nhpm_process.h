#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>

#include "nhpm/config.h"

namespace conav::test {

/// The program conav-nhpm as a process of its own, beside participants of OverDds(). Its config and
/// log lie in a temporary folder that goes with it.
class NhpmProcess {
 public:
  explicit NhpmProcess(const std::string& vendor) {
    std::string pattern = (std::filesystem::temp_directory_path() / "nhpm-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    folder_ = pattern;
    nhpm::NhpmConfig config;
    config.bus.vendor = vendor;
    config.bus.domain_id = 20 + static_cast<int>(getpid()) % 200;
    config.bus.interface = "lo";
    std::ofstream(folder_ / "nhpm.yaml") << DumpConfig("nhpm", config);
    Start();
  }
  ~NhpmProcess() {
    if (pid_ > 0) End(SIGKILL);
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  NhpmProcess(const NhpmProcess&) = delete;
  NhpmProcess& operator=(const NhpmProcess&) = delete;

  /// Once more, after End().
  void Start() {
    const std::string program = std::string(CONAV_BIN_DIR) + "/conav-nhpm";
    const std::string config = folder_ / "nhpm.yaml";
    const std::string log = folder_ / "log";
    pid_ = fork();
    REQUIRE(pid_ >= 0);
    if (pid_ > 0) return;
    dup2(open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600), STDERR_FILENO);
    execl(program.c_str(), program.c_str(), "--config", config.c_str(), nullptr);
    _exit(127);
  }

  /// Sends `signal`; returns the exit code, or -1 when the signal ended it.
  int End(int signal) {
    kill(pid_, signal);
    int status = 0;
    REQUIRE(waitpid(pid_, &status, 0) == pid_);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  void Signal(int signal) const { kill(pid_, signal); }

 private:
  std::filesystem::path folder_;
  pid_t pid_ = -1;
};

}  // namespace conav::test
