#pragma once

#include <cstddef>
#include <cstdint>

namespace conav::operators {

/// How many cells fit into one Request of a page (idl/console.proto), whatever they are.
struct RequestLimits {
  std::uint32_t edit_cells = 0;
  std::uint32_t path_cells = 0;
  bool operator==(const RequestLimits&) const = default;
};

/// `message_bytes`: the longest message that is taken. `most`: what else limits them.
RequestLimits LimitsOf(std::size_t message_bytes, RequestLimits most);

}  // namespace conav::operators
