#include "support/test_domain.h"

#include <unistd.h>

#include "common/runtime/result.h"

namespace conav::test {
namespace {

constexpr int kFirstDomain = 40;
constexpr int kDomains = 60;

}  // namespace

launcher::DomainLease LeaseDomain() {
  for (int i = 0; i < kDomains; ++i) {
    const int domain = kFirstDomain + (getpid() + i) % kDomains;
    auto lease = launcher::DomainLease::TryAcquire(domain, "test");
    if (lease && launcher::DomainLease::TryAcquire(domain)) return *std::move(lease);
  }
  throw StartupError("no DDS domain is free for this test");
}

int TestDomain() {
  static const launcher::DomainLease lease = LeaseDomain();
  return lease.domain();
}

}  // namespace conav::test
