#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace conav::bus {

/// A DDS GUID as on the wire: 12 bytes participant, 4 bytes entity.
using Guid = std::array<std::uint8_t, 16>;

/// Identifies a request of a ROS 2 service, and its reply.
struct RequestId {
  /// As the vendor's RMW names clients: Reader::client_id().
  Guid client{};
  std::int64_t number = 0;
  friend bool operator==(const RequestId&, const RequestId&) = default;
};

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
  /// Of requests and replies (service.h) the id, which each vendor transports in its own way and which
  /// is no part of the payload; null for other types.
  RequestId& (*request_id)(void* message) = nullptr;
};

inline constexpr std::size_t kEncapsulationSize = 4;
inline constexpr std::size_t kMaximumKeySize = 16;

/// serialized_size, serialize and deserialize for a vendor without a place for request ids: as ROS 2's
/// rmw_cyclonedds_cpp has it, 16 bytes (the client's name, 8 bytes, and the number) come between the
/// encapsulation and the message. The same as those functions for types without request id.
std::size_t PayloadSize(const TypeSupport& type, const void* message);
std::size_t ToPayload(const TypeSupport& type, const void* message,
                      std::span<std::uint8_t> payload);
bool FromPayload(const TypeSupport& type, std::span<const std::uint8_t> payload, void* message);

/// The one TypeSupport of a fastddsgen class. type_support.cc instantiates it for the type of each
/// topic. To use another type, include type_support_of.h.
template <class T>
const TypeSupport& TypeSupportOf();

}  // namespace conav::bus
