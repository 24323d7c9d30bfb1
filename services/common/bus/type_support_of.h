#pragma once

#include <fastcdr/Cdr.h>

#include <exception>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/bus/type_support.h"

// One user: so that users of the bus do not compile Fast CDR; tests instantiate types of their own.

/// The definition of TypeSupportOf<T> over a fastddsgen class.
namespace conav::bus {

/// "conav_msgs::msg::RobotState" becomes "conav_msgs::msg::dds_::RobotState_", the name that ROS 2
/// gives the type in DDS.
std::string RosTypeName(std::string_view cpp_name);

namespace internal {

/// The C++ name of T, read from the compiler's signature of this very function
/// ("... CppName() [with T = a::b; std::string_view = ...]" of g++, "[T = a::b]" of clang).
template <class T>
constexpr std::string_view CppName() {
  constexpr std::string_view kSignature = __PRETTY_FUNCTION__;
  constexpr std::size_t kStart = kSignature.find("T = ") + 4;
  constexpr std::size_t kEnd = kSignature.find_first_of(";]", kStart);
  return kSignature.substr(kStart, kEnd - kStart);
}

/// The fastddsgen class that travels: a request or reply without its envelope (services.h).
template <class T>
auto& Body(T& message) {
  if constexpr (requires { message.id.client; }) {
    return message.message;
  } else {
    return message;
  }
}

template <class T>
using BodyOf = std::remove_cvref_t<decltype(Body(std::declval<T&>()))>;

/// Whether the type is the result of an action that got fields after Humble: a shorter one of an older
/// server is read as if they were zero.
template <class T>
constexpr bool kHasGrown = requires(T& message) {
  message.result().error_code();
};

template <class T>
std::size_t SerializedSize(const void* message) {
  return kEncapsulationSize +
         BodyOf<T>::getCdrSerializedSize(Body(*static_cast<const T*>(message)));
}

template <class T>
std::size_t Serialize(const void* message, std::span<std::uint8_t> payload) {
  using eprosima::fastcdr::Cdr;
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  try {
    cdr.serialize_encapsulation();
    Body(*static_cast<const T*>(message)).serialize(cdr);
  } catch (const std::exception&) {
    return 0;
  }
  return cdr.getSerializedDataLength();
}

template <class T>
bool Deserialize(std::span<const std::uint8_t> payload, void* message) {
  using eprosima::fastcdr::Cdr;
  // Accepts plain CDR only, big or little endian; parameter lists and XCDR2 have another layout.
  if (payload.size() < kEncapsulationSize || payload[0] != 0 || payload[1] > 1) return false;
  std::vector<std::uint8_t> extended;
  if constexpr (kHasGrown<BodyOf<T>>) {
    constexpr std::size_t kRoomForNewFields = 16;
    extended.assign(payload.begin(), payload.end());
    extended.resize(payload.size() + kRoomForNewFields);
    payload = extended;
  }
  auto* bytes = const_cast<char*>(reinterpret_cast<const char*>(payload.data()));
  eprosima::fastcdr::FastBuffer buffer(bytes, payload.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  try {
    cdr.read_encapsulation();
    Body(*static_cast<T*>(message)).deserialize(cdr);
  } catch (const std::exception&) {
    return false;
  }
  return true;
}

template <class T>
std::size_t SerializeKey(const void* message, std::span<std::uint8_t> key) {
  using eprosima::fastcdr::Cdr;
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(key.data()), key.size());
  Cdr cdr(buffer, Cdr::BIG_ENDIANNESS);
  try {
    Body(*static_cast<const T*>(message)).serializeKey(cdr);
  } catch (const std::exception&) {
    return 0;
  }
  return cdr.getSerializedDataLength();
}

}  // namespace internal

/// `name` is for types whose C++ name is not their ROS name.
template <class T>
TypeSupport MakeTypeSupport(std::string name) {
  return {std::move(name),
          &internal::SerializedSize<T>,
          &internal::Serialize<T>,
          &internal::Deserialize<T>,
          [] { return static_cast<void*>(new T()); },
          [](void* message) { delete static_cast<T*>(message); },
          internal::BodyOf<T>::isKeyDefined(),
          &internal::SerializeKey<T>};
}

template <class T>
const TypeSupport& TypeSupportOf() {
  static const TypeSupport support = [] {
    using Body = internal::BodyOf<T>;
    TypeSupport made = MakeTypeSupport<T>(RosTypeName(internal::CppName<Body>()));
    if constexpr (!std::is_same_v<T, Body>) {
      made.request_id = [](void* message) -> RequestId& { return static_cast<T*>(message)->id; };
    }
    return made;
  }();
  return support;
}

}  // namespace conav::bus
