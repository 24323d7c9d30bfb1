#include "launcher/domain_lease.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <utility>

#include "support/taken_port.h"

namespace conav::launcher {
namespace {

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

TEST_CASE("a port is refused by option and port while somebody listens on it", "[launcher]") {
  int port = 0;
  {
    const test::TakenPort taken;
    port = taken.port;
    const auto checked = CheckPort("--console", port);
    REQUIRE_FALSE(checked);
    CHECK(checked.error().code == ErrorCode::kUnavailable);
    CHECK_THAT(checked.error().text, Catch::StartsWith(fmt::format("--console {}: ", port)));
  }
  CHECK(CheckPort("--port", port));
  CHECK(CheckPort("--port", 0));
}

}  // namespace
}  // namespace conav::launcher
