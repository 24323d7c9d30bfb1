#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav::nhpm {

/// What a file of a given kind starts with.
struct FrameKind {
  std::string_view magic;  // 4 characters
  std::uint32_t version = 1;
  std::string_view name;  // for messages: "weights file"
};

/// Puts a payload into a frame that shows damage:
///
///   magic  version  payload size  SHA-256 of the payload  payload
///   4      4        8             64 hexadecimal digits   (bytes; numbers little-endian)
std::string Frame(const FrameKind& kind, std::string_view payload);

/// The payload within `bytes`. Errors: kMalformed, saying what is wrong: not of this kind, cut off,
/// too long, another version, another SHA-256.
[[nodiscard]] Result<std::string_view> Unframe(const FrameKind& kind, std::string_view bytes);

}  // namespace conav::nhpm
