#pragma once

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <string>

#include "support/child_process.h"
#include "support/loopback.h"

namespace conav::test {

/// bus_peer on that vendor in the domain of this test process; ready when the constructor returns.
/// Wait() asks it to end, Kill() leaves the bus no goodbye.
class PeerProcess : public ChildProcess {
 public:
  explicit PeerProcess(const std::string& vendor, const std::string& extra = "")
      : ChildProcess(fmt::format("exec '{}/bus_peer' {} {} {}", CONAV_BIN_DIR, vendor, TestDomain(),
                                 extra)) {
    REQUIRE(ReadUntil("ready\n"));
  }
};

}  // namespace conav::test
