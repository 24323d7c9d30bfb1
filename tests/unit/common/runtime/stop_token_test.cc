#include <catch2/catch.hpp>
#include <csignal>

#include "common/runtime/threads.h"

namespace conav {

TEST_CASE("a stop stays requested", "[runtime]") {
  StopToken token;
  CHECK_FALSE(token.stop_requested());
  token.RequestStop();
  CHECK(token.stop_requested());
  token.RequestStop();
  CHECK(token.stop_requested());
}

TEST_CASE("SIGTERM requests the process's stop", "[runtime]") {
  InstallStopSignals();
  REQUIRE_FALSE(ProcessStopToken().stop_requested());
  REQUIRE(std::raise(SIGTERM) == 0);
  CHECK(ProcessStopToken().stop_requested());
}

}  // namespace conav
