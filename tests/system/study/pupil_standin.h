#pragma once

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <string>

#include "support/child_process.h"

namespace conav::testing {

/// Pupil Capture's stand-in, tests/support/pupil_standin.py (synthetic); its address is known once it
/// is made.
class Standin {
 public:
  explicit Standin(const std::string& options)
      : process_(fmt::format("exec '{}/support/pupil_standin.py' {}", CONAV_TESTS_DIR, options)) {
    const std::string begin = "pupil remote ";
    REQUIRE(process_.ReadUntil(begin));
    process_.TakeText();
    REQUIRE(process_.ReadUntil("\n"));
    address_ = process_.TakeText();
    address_.pop_back();
  }

  const std::string& address() const { return address_; }
  std::string port() const { return address_.substr(address_.rfind(':') + 1); }
  void Play() { process_.Send("go"); }
  void WaitForEnd() { REQUIRE(process_.ReadUntil("sent ")); }
  void Kill() { process_.Kill(); }

 private:
  test::ChildProcess process_;
  std::string address_;
};

}  // namespace conav::testing
