#include "launcher/domain_lease.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <utility>

#include "support/taken_port.h"

namespace conav::launcher {
namespace {

using conav::launcher::DomainLease;

TEST_CASE("a domain is leased once and free again afterwards", "[launcher]") {
  constexpr int kDomain = 231;  // no demo asks for it by itself
  auto first = DomainLease::TryAcquire(kDomain);
  REQUIRE(first);
  CHECK(first->domain() == kDomain);
  CHECK_FALSE(DomainLease::TryAcquire(kDomain));
  {
    const DomainLease moved = *std::move(first);
    CHECK_FALSE(DomainLease::TryAcquire(kDomain));
  }
  CHECK(DomainLease::TryAcquire(kDomain));
}

TEST_CASE("a port that somebody listens on is refused by option, port and cause", "[launcher]") {
  const test::TakenPort taken;
  const auto checked = CheckPort("--console", taken.port);
  REQUIRE_FALSE(checked);
  CHECK(checked.error().code == ErrorCode::kUnavailable);
  CHECK_THAT(checked.error().text, Catch::StartsWith(fmt::format("--console {}: ", taken.port)));
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
