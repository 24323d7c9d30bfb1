#include "launcher/domain_lease.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/runtime/result.h"

namespace conav::launcher {

std::optional<DomainLease> DomainLease::TryAcquire(int domain, std::string_view holder) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("conav-{}-{}.lock", holder, domain);
  // Opened for reading only where it is another user's: a lock needs no more.
  int descriptor = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
  if (descriptor < 0) descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) {
    throw StartupError(fmt::format("{}: cannot open: {}", file.string(), std::strerror(errno)));
  }
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return DomainLease(domain, descriptor);
  close(descriptor);
  return std::nullopt;
}

DomainLease::DomainLease(DomainLease&& other) noexcept
    : domain_(other.domain_), descriptor_(std::exchange(other.descriptor_, -1)) {}

DomainLease::~DomainLease() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace conav::launcher
