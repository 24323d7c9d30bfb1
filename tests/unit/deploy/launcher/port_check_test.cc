#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "launcher/domain_lease.h"
#include "support/taken_port.h"

namespace conav::launcher {
namespace {

TEST_CASE("a port that somebody listens on is refused by option, port and cause", "[launcher]") {
  const test::TakenPort taken;
  const auto checked = CheckPort("--console", taken.port);
  REQUIRE_FALSE(checked);
  CHECK(checked.error().code == ErrorCode::kUnavailable);
  CHECK_THAT(checked.error().text, Catch::StartsWith(fmt::format("--console {}: ", taken.port)) &&
                                       Catch::Contains("Address already in use"));
}

TEST_CASE("a port that was let go can be had again, and any port always", "[launcher]") {
  int port = 0;
  {
    const test::TakenPort taken;
    port = taken.port;
  }
  CHECK(CheckPort("--port", port));
  CHECK(CheckPort("--port", 0));
}

}  // namespace
}  // namespace conav::launcher
