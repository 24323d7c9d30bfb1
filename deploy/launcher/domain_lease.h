#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav::launcher {

/// Whether a page can be served at `port` of this machine; always true for 0. Errors: kUnavailable
/// names `option`, port and cause.
[[nodiscard]] Result<void> CheckPort(const std::string& option, int port);

/// Reserves a DDS domain for one demo on this machine, by a lock on a file in the temporary folder.
/// The kernel releases it however the process ends.
class DomainLease {
 public:
  /// Empty if a process on this machine holds it under the same `holder`. A test reserves its
  /// domain under a name of its own, so that the demo it starts can have the domain, too.
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
