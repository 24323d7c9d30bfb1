#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "support/running_program.h"
#include "support/temporary_folder.h"
#include "support/test_domain.h"

namespace conav::testing {

using test::TestDomain;
using test::WaitUntil;

/// What the table of a run holds, without wall times.
nlohmann::json Table(nlohmann::json result);

/// One `conav demo` in a temporary folder of its own.
class DemoRun : test::TemporaryFolder, public test::RunningProgram {
 public:
  /// Starts it with `arguments` after `conav demo`; --domain, --out and --json are added. `prefix`
  /// is put before the command.
  explicit DemoRun(const std::string& arguments, const std::string& prefix = "");

  /// Blocks until it has ended and returns its exit code; fails the test when `limit` passes.
  int Wait(std::chrono::seconds limit = std::chrono::seconds(150));
  /// Waits for its end, which must be with exit code 0; returns the object of --json.
  nlohmann::json EndsWell();
  /// The same; every robot has moved, and every goal is reached.
  nlohmann::json ReachesAllGoals();
  /// The number after "started `service` (pid "; waits for it.
  pid_t PidOf(const std::string& service);
  /// Waits until a robot with a name like this has moved; fails the test when none does.
  void WaitForMoves(const std::string& robot = "r[0-9]+");
  /// The object of --json; null when there is none.
  nlohmann::json Json() const;
  std::filesystem::path RunFolder() const;
  /// Output and the ends of all logs, for the message of a failed check.
  std::string Story() const;
};

}  // namespace conav::testing
