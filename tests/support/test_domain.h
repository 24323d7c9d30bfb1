#pragma once

namespace conav::test {

/// A DDS domain that no other test process of this machine uses, kept until this process ends, and
/// that no `conav demo` used when it was taken. In [40, 99]: above the domains that a demo tries by itself, and with all its
/// ports below the ephemeral ones. Throws StartupError when all are taken.
int TestDomain();

}  // namespace conav::test
