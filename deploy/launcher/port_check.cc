#include "launcher/port_check.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>

namespace conav::launcher {
namespace {

/// 0, or why not.
int TryPort(int port) {
  const int descriptor = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return errno;
  const int yes = 1;  // as the gateway does: connections that were closed a moment ago do no harm
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
              fmt::format("{} {}: cannot be had ({}); choose another, or 0 for any that is free",
                          option, port, std::strerror(cause)));
}

}  // namespace conav::launcher
