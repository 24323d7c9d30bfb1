#pragma once

#include <fmt/format.h>
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav::test {

/// How a program ended, and what it said.
struct ProgramOutcome {
  int code = -1;
  std::string out;
  std::string error;
};

/// A folder of its own in which one of our programs is run, as a user would run it.
class ProgramDesk {
 public:
  explicit ProgramDesk(std::string program) : program_(std::move(program)) {}

  /// `arguments` as typed into a shell.
  ProgramOutcome Run(const std::string& arguments) const {
    const std::string command =
        fmt::format("cd '{}' && '{}/{}' {} >out 2>error </dev/null", folder_.path().string(),
                    CONAV_BIN_DIR, program_, arguments);
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), ReadFile(folder_ / "out").value(),
            ReadFile(folder_ / "error").value()};
  }
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

 private:
  std::string program_;
  TemporaryFolder folder_;
};

}  // namespace conav::test
