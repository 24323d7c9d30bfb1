#pragma once

#include <poll.h>

#include <chrono>
#include <functional>

namespace conav::test {

/// True as soon as `condition` holds; false when `limit` passed before.
inline bool WaitUntil(const std::function<bool()>& condition,
                      std::chrono::milliseconds limit = std::chrono::seconds(10)) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    poll(nullptr, 0, 10);
  }
  return true;
}

}  // namespace conav::test
