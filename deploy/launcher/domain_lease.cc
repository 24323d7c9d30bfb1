#include "launcher/domain_lease.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <utility>

namespace conav::launcher {
namespace {

/// 0, or the error number.
int TryPort(int port) {
  const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return errno;
  const int yes = 1;  // as the gateway does: recently closed connections do not matter
  setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int failed = bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address);
  const int cause = failed == 0 ? 0 : errno;
  close(descriptor);
  return cause;
}

}  // namespace

Result<void> CheckPort(const std::string& option, int port) {
  const int cause = port == 0 ? 0 : TryPort(port);
  if (cause == 0) return {};
  return Fail(ErrorCode::kUnavailable,
              fmt::format("{} {}: not available ({}); choose another, or 0 for any free one",
                          option, port, std::strerror(cause)));
}

std::optional<DomainLease> DomainLease::TryAcquire(int domain, std::string_view holder) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("conav-{}-{}.lock", holder, domain);
  // If it belongs to another user, open it for reading: that is enough for a lock.
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
