#include "operator/console/request_limits.h"

#include <algorithm>

namespace conav::operators {
namespace {

/// A Cell with two numbers of two bytes (maps have up to 1024 rows and columns), its tag and length; a
/// CellEdit with one of these and `wall`, its tag and length.
constexpr std::size_t kPathCellBytes = 8;
constexpr std::size_t kEditCellBytes = 12;
/// The rest of a request: names, numbers, the messages around.
constexpr std::size_t kOtherBytes = 512;

std::uint32_t Fitting(std::size_t message_bytes, std::size_t cell_bytes, std::uint32_t most) {
  const std::size_t room = std::max(message_bytes, kOtherBytes) - kOtherBytes;
  return static_cast<std::uint32_t>(std::min<std::size_t>(room / cell_bytes, most));
}

}  // namespace

RequestLimits LimitsOf(std::size_t message_bytes, RequestLimits most) {
  return {Fitting(message_bytes, kEditCellBytes, most.edit_cells),
          Fitting(message_bytes, kPathCellBytes, most.path_cells)};
}

}  // namespace conav::operators
