#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/type_support.h"
#include "test_types.h"

/// Messages whose every byte can be checked, and waiting without sleeping.
namespace conav::test {

inline std::vector<std::uint8_t> Pattern(std::uint64_t id, std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  for (std::size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<std::uint8_t>(id * 131 + i * 7 + (i >> 8));
  }
  return bytes;
}

inline conav_test::msg::Blob MakeBlob(std::uint64_t id, std::size_t size) {
  conav_test::msg::Blob blob;
  blob.id(id);
  blob.data(Pattern(id, size));
  return blob;
}

inline conav_test::msg::KeyedBlob MakeKeyedBlob(std::int32_t instance, std::uint64_t id,
                                                std::size_t size) {
  conav_test::msg::KeyedBlob blob;
  blob.instance(instance);
  blob.id(id);
  blob.data(Pattern(id, size));
  return blob;
}

/// Bytes that go out as they are, announced as a Blob: for payloads that are no Blob.
struct RawBlob {
  std::vector<std::uint8_t> bytes;
};

/// Looks at `condition` whenever `participant` receives something, and at least 50 times a second.
template <class Condition>
bool WaitUntil(bus::Participant& participant, Condition&& condition,
               std::chrono::seconds limit = std::chrono::seconds(10)) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    participant.Wait(std::chrono::milliseconds(20));
  }
  return true;
}

}  // namespace conav::test

namespace conav::bus {

template <>
inline const TypeSupport& TypeSupportOf<test::RawBlob>() {
  using test::RawBlob;
  static const TypeSupport kSupport = {
      TypeSupportOf<conav_test::msg::Blob>().name,
      [](const void* message) { return static_cast<const RawBlob*>(message)->bytes.size(); },
      [](const void* message, std::span<std::uint8_t> payload) {
        const auto& bytes = static_cast<const RawBlob*>(message)->bytes;
        std::copy(bytes.begin(), bytes.end(), payload.begin());
        return bytes.size();
      },
      [](std::span<const std::uint8_t> payload, void* message) {
        static_cast<RawBlob*>(message)->bytes.assign(payload.begin(), payload.end());
        return true;
      },
      [] { return static_cast<void*>(new RawBlob); },
      [](void* message) { delete static_cast<RawBlob*>(message); }};
  return kSupport;
}

}  // namespace conav::bus
