#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav::launcher {

/// Whether a page can be served at `port` of this machine, which `option` names; 0 always can.
/// Errors: kUnavailable names option, port and cause.
[[nodiscard]] Result<void> CheckPort(const std::string& option, int port);

/// A DDS domain kept for one demo on this machine, by a lock on a file in the temporary folder; the
/// kernel lets go of it when the process ends in whatever way.
class DomainLease {
 public:
  /// Nothing when another `holder` of that name on this machine holds it. A test holds its domain
  /// under a name of its own, so that the demo which it starts can have the domain, too.
  static std::optional<DomainLease> TryAcquire(int domain, std::string_view holder = "domain");

  DomainLease(DomainLease&& other) noexcept;
  DomainLease& operator=(DomainLease&&) = delete;
  ~DomainLease();

  int domain() const { return domain_; }

 private:
  DomainLease(int domain, int descriptor) : domain_(domain), descriptor_(descriptor) {}

  int domain_;
  int descriptor_;
};

}  // namespace conav::launcher
