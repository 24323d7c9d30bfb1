#include "launcher/domain_lease.h"

#include <catch2/catch.hpp>
#include <utility>

using conav::launcher::DomainLease;

TEST_CASE("a domain is leased once and free again afterwards", "[launcher][domain]") {
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
