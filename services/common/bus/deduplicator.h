#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace conav::bus {

/// A DDS GUID as on the wire: 12 bytes participant, 4 bytes entity.
using Guid = std::array<std::uint8_t, 16>;

/// Keeps a sample from arriving twice. After a link was cut and restored, a transient-local writer
/// sends its history again and a reader that takes at once cannot tell; so the last kWindow stamps
/// (sequence numbers or source timestamps) of each writer are remembered here.
/// Threads: one at a time.
class Deduplicator {
 public:
  /// True unless `stamp` is among the last kWindow that came from `writer`.
  bool IsNew(const Guid& writer, std::int64_t stamp);

  static constexpr std::size_t kWindow = 512;  // more than any history of the topic table
  static constexpr std::size_t kWriters = 256;

 private:
  struct Window {
    Guid writer;
    std::vector<std::int64_t> stamps;  // a ring once it holds kWindow
    std::size_t oldest = 0;
  };

  Window& WindowOf(const Guid& writer);

  std::vector<Window> windows_;  // most recently used last
};

}  // namespace conav::bus
