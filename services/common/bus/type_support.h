#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace conav::bus {

/// What a backend must know about a message type. Payloads are CDR (XCDR1) with the 4-byte
/// encapsulation header.
struct TypeSupport {
  std::string name;  // "conav_msgs::msg::dds_::RobotState_"
  /// Bytes that Serialize() will write for this message, encapsulation included.
  std::size_t (*serialized_size)(const void* message);
  /// Returns the bytes written; 0 when `payload` is too small.
  std::size_t (*serialize)(const void* message, std::span<std::uint8_t> payload);
  /// False when `payload` is not a T. Never throws, never allocates for a length that the payload
  /// cannot hold.
  bool (*deserialize)(std::span<const std::uint8_t> payload, void* message);
  void* (*create)();
  void (*destroy)(void* message);
  /// The type has @key members. ROS 2 topics never do; fixed-size keys of at most kMaximumKeySize
  /// bytes are supported.
  bool keyed = false;
  /// Writes the key members as big-endian CDR without encapsulation; returns the bytes written.
  std::size_t (*serialize_key)(const void* message, std::span<std::uint8_t> key) = nullptr;
};

inline constexpr std::size_t kEncapsulationSize = 4;
inline constexpr std::size_t kMaximumKeySize = 16;

/// The one TypeSupport of a fastddsgen class. type_support.cc instantiates it for the type of each
/// topic. To use another type, include type_support_of.h.
template <class T>
const TypeSupport& TypeSupportOf();

}  // namespace conav::bus
