#pragma once

#include <fastcdr/Cdr.h>

#include <exception>
#include <string>
#include <string_view>
#include <utility>

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

template <class T>
std::size_t SerializedSize(const void* message) {
  return kEncapsulationSize + T::getCdrSerializedSize(*static_cast<const T*>(message));
}

template <class T>
std::size_t Serialize(const void* message, std::span<std::uint8_t> payload) {
  using eprosima::fastcdr::Cdr;
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  try {
    cdr.serialize_encapsulation();
    static_cast<const T*>(message)->serialize(cdr);
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
  auto* bytes = const_cast<char*>(reinterpret_cast<const char*>(payload.data()));
  eprosima::fastcdr::FastBuffer buffer(bytes, payload.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  try {
    cdr.read_encapsulation();
    static_cast<T*>(message)->deserialize(cdr);
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
    static_cast<const T*>(message)->serializeKey(cdr);
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
          T::isKeyDefined(),
          &internal::SerializeKey<T>};
}

template <class T>
const TypeSupport& TypeSupportOf() {
  static const TypeSupport support = MakeTypeSupport<T>(RosTypeName(internal::CppName<T>()));
  return support;
}

}  // namespace conav::bus
