#pragma once

#include <cstdint>
#include <vector>

namespace conav::bench {

/// JPEGs of the simulator's camera in a maze, in its usual size and quality. Throws StartupError.
std::vector<std::vector<std::uint8_t>> CameraPictures(int count);

}  // namespace conav::bench
