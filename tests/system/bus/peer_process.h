#pragma once

#include <catch2/catch.hpp>
#include <csignal>
#include <string>
#include <vector>

#include "common/runtime/file.h"
#include "launcher/process.h"
#include "support/loopback.h"
#include "support/temporary_folder.h"
#include "support/wait.h"
#include "system/bus/peer_topics.h"

namespace conav::test {

/// A bus_peer process; ready when the constructor returns, gone when the destructor does.
class PeerProcess {
 public:
  /// `extra`: see bus_peer.cc.
  explicit PeerProcess(const std::string& vendor, const std::string& extra = "jazzy")
      : process_("bus_peer",
                 {CONAV_BIN_DIR "/bus_peer", vendor, std::to_string(TestDomain()), extra},
                 folder_ / "log") {
    const auto ready = [this] { return ReadFile(folder_ / "log").value_or("") == "ready\n"; };
    REQUIRE(test::WaitUntil(ready));
  }

  void Signal(int signal) { process_.Signal(signal); }
  /// SIGTERM asks it to end, SIGKILL is a crash: no goodbye on the bus. Returns how it ended.
  launcher::ProcessEnd End(int signal) {
    process_.Signal(signal);
    REQUIRE(test::WaitUntil([this] { return process_.Poll(); }));
    return *process_.end();
  }

 private:
  TemporaryFolder folder_;
  launcher::Process process_;
};

/// A participant here and a peer process there, for each pair of vendors.
struct VendorPair {
  std::string here = GENERATE("cyclonedds", "fastdds");
  std::string there = GENERATE("cyclonedds", "fastdds");
  PeerProcess peer{there};
  bus::Participant participant{"bus_test", OnLoopback(here)};
};

}  // namespace conav::test
