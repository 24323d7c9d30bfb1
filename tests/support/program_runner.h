#pragma once

#include <fmt/core.h>
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav::test {

/// How a program ended, and what it said.
struct ProgramOutcome {
  int exit_code = -1;  // 128 + the signal that ended it
  std::string out;
  std::string error;

  std::string text() const { return out + error; }
};

/// A folder of its own in which one of our programs is run, as a user would run it.
class ProgramRunner {
 public:
  explicit ProgramRunner(std::string program) : program_(std::move(program)) {}

  /// `arguments` as typed into a shell; they may send the program's output elsewhere.
  ProgramOutcome Run(const std::string& arguments) const { return RunOther(program_, arguments); }
  ProgramOutcome RunOther(const std::string& program, const std::string& arguments) const {
    const auto out = streams_ / "out";
    const auto error = streams_ / "error";
    const std::string command = fmt::format(
        "cd '{}' && exec >'{}' 2>'{}' </dev/null && exec '{}/{}' {}", folder_.path().string(),
        out.string(), error.string(), CONAV_BIN_DIR, program, arguments);
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), ReadFile(out).value(),
            ReadFile(error).value()};
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  std::string program_;
  TemporaryFolder folder_;
  TemporaryFolder streams_;
};

/// Runs `program` in an empty folder.
inline ProgramOutcome RunProgram(const std::string& program, const std::string& arguments) {
  return ProgramRunner(program).Run(arguments);
}

}  // namespace conav::test
