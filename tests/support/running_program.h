#pragma once

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <string>

#include "common/runtime/file.h"
#include "launcher/process.h"
#include "support/wait.h"

namespace conav::test {

/// One of our programs in the background, started as a user starts it; what it prints goes into a
/// file. Killed with this object.
class RunningProgram {
 public:
  /// `arguments` as typed into a shell; `prefix`: the words before the program.
  RunningProgram(const std::string& program, const std::string& arguments,
                 const std::filesystem::path& output, const std::string& prefix = "")
      : process_(program,
                 {"sh", "-c",
                  fmt::format("exec {} '{}/{}' {}", prefix, CONAV_BIN_DIR, program, arguments)},
                 output) {}

  pid_t pid() const { return process_.pid(); }
  void Signal(int signal) { process_.Signal(signal); }
  std::string Output() const { return ReadFile(process_.log()).value_or(""); }
  /// Waits until it has printed `text`; false when it ends first, or does not within a minute.
  bool Prints(const std::string& text) {
    const auto printed = [&] { return Output().find(text) != std::string::npos; };
    return WaitUntil([&] { return printed() || process_.Poll(); }, std::chrono::minutes(1)) &&
           printed();
  }
  /// Waits for its end; false when it goes on beyond `limit`.
  bool Ends(std::chrono::seconds limit) {
    return WaitUntil([this] { return process_.Poll(); }, limit);
  }
  /// The same; fails the test when it goes on.
  launcher::ProcessEnd Wait(std::chrono::seconds limit = std::chrono::minutes(1)) {
    if (!Ends(limit)) FAIL(Output());
    return *process_.end();
  }

 private:
  launcher::Process process_;
};

}  // namespace conav::test
