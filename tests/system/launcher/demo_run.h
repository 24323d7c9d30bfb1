#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "launcher/process.h"
#include "support/test_domain.h"

namespace conav::testing {

using test::TestDomain;

/// True as soon as `condition` holds; false when `limit` passed before.
bool WaitUntil(const std::function<bool()>& condition, std::chrono::seconds limit);

/// One `conav demo` in a folder of its own below the temporary folder, removed at the end.
class DemoRun {
 public:
  /// Starts it with `arguments` after `conav demo`; --domain, --out and --json are added. `prefix`
  /// is put before the command.
  explicit DemoRun(const std::vector<std::string>& arguments,
                   const std::vector<std::string>& prefix = {});
  ~DemoRun();

  /// Blocks until it has ended and returns its exit code; fails the test when `limit` passes.
  int Wait(std::chrono::seconds limit = std::chrono::seconds(150));
  void Signal(int signal) { process_->Signal(signal); }

  /// What it has printed so far.
  std::string Output() const;
  /// The number after "started `service` (pid "; waits for it.
  pid_t PidOf(const std::string& service);
  /// Waits until a robot has moved.
  bool WaitForMoves();
  /// The object of --json; null when there is none.
  nlohmann::json Json() const;
  std::filesystem::path RunFolder() const;
  /// Output and the ends of all logs, for the message of a failed check.
  std::string Story() const;

 private:
  std::filesystem::path folder_;
  std::unique_ptr<launcher::Process> process_;
};

}  // namespace conav::testing
