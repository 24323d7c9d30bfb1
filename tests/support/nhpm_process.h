#pragma once

#include <catch2/catch.hpp>
#include <csignal>
#include <optional>
#include <string>

#include "common/runtime/file.h"
#include "nhpm/config.h"
#include "support/loopback.h"
#include "support/service_process.h"
#include "support/temporary_folder.h"

namespace conav::test {

/// The program conav-nhpm as a process of its own, next to participants of OverDds(). Its config
/// lies in a temporary folder that goes with it.
class NhpmProcess {
 public:
  /// `weights` = a file of the network; empty = the GLPF.
  explicit NhpmProcess(const std::string& vendor, const std::string& weights = "")
      : NhpmProcess(vendor, nhpm::NhpmConfig{.model = weights.empty() ? PerceptionModelKind::kGlpf
                                                                      : PerceptionModelKind::kNhpm,
                                             .weights = weights}) {}
  /// What it serves is said by `config`.
  NhpmProcess(const std::string& vendor, nhpm::NhpmConfig config) {
    config.bus = OnLoopback(vendor);
    config.name = "nhpm-test";
    REQUIRE(WriteFile(folder_ / "nhpm.yaml", DumpConfig("nhpm", config)));
    Start();
  }

  /// Once more, after End().
  void Start() { process_.emplace("conav-nhpm", folder_ / "nhpm.yaml"); }

  /// Sends `signal`; returns the exit code, or -1 when a signal ended it.
  int End(int signal) {
    const launcher::ProcessEnd end = process_->End(signal);
    return end.signal == 0 ? end.exit_code : -1;
  }

  void Signal(int signal) { process_->Signal(signal); }

 private:
  TemporaryFolder folder_;
  std::optional<ServiceProcess> process_;  // ends before its folder goes
};

}  // namespace conav::test
