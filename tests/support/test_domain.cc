#include "support/test_domain.h"

#include <unistd.h>

#include "common/runtime/result.h"
#include "launcher/domain_lease.h"

namespace conav::test {
namespace {

constexpr int kFirstDomain = 40;
constexpr int kDomains = 60;

/// Tests have leases of their own, so that a demo which a test starts can take the domain's.
launcher::DomainLease AcquireDomain() {
  for (int i = 0; i < kDomains; ++i) {
    const int domain = kFirstDomain + (getpid() + i) % kDomains;
    auto lease = launcher::DomainLease::TryAcquire(domain, "test");
    if (lease && launcher::DomainLease::TryAcquire(domain)) return *std::move(lease);
  }
  throw StartupError("no DDS domain is free for this test");
}

}  // namespace

int TestDomain() {
  static const launcher::DomainLease lease = AcquireDomain();
  return lease.domain();
}

}  // namespace conav::test
