#pragma once

#include "launcher/domain_lease.h"

namespace conav::test {

/// A DDS domain that no other test or benchmark of this machine uses while the lease lives, and
/// that no `conav demo` used when it was taken: tests have leases of their own, so that a demo which a
/// test starts can take the domain's. In [40, 99]: above the domains that a demo tries by itself,
/// and with all its ports below the ephemeral ones. Throws StartupError when all are taken.
launcher::DomainLease LeaseDomain();

/// One such domain, kept until this process ends.
int TestDomain();

}  // namespace conav::test
