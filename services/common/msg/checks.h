#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/grid/geometry.h"
#include "common/grid/grid.h"
#include "common/runtime/result.h"

/// Limits and checks of values from other programs, in IDL or protobuf; for converters only.
namespace conav::convert {

inline constexpr std::uint32_t kMaxSide = 2048;           // rows, columns
inline constexpr double kMaxPosition = 1.0e6;             // metres from the map frame's origin
inline constexpr std::size_t kMaxPath = 65536;            // cells of a path, goals, edits
inline constexpr std::size_t kMaxVisible = 1U << 20;      // cells that one picture shows
inline constexpr std::size_t kMaxJpegBytes = 16U << 20;   // 16 MiB
inline constexpr std::uint32_t kMaxImageSide = 16384;     // pixels
inline constexpr std::size_t kMaxClient = 128;            // characters of a client
inline constexpr std::size_t kMaxText = 4096;             // characters of a reason
inline constexpr std::size_t kMaxRobots = 4096;           // of a process, or of a request
inline constexpr std::size_t kMaxActions = 4096;          // at the root of a search
inline constexpr std::size_t kMaxQueries = 1024;          // in one perception request
inline constexpr std::size_t kMaxQueryValues = 1U << 24;  // cells of all beliefs of a request

/// Collects the first error of a message or request. Each check returns the value, or a harmless
/// one on failure; the caller looks at `failed()` once, at the end.
class ValueChecks {
 public:
  bool failed() const { return error_.has_value(); }
  tl::unexpected<Error> failure() const { return tl::unexpected<Error>(*error_); }
  template <class Value>
  Result<Value> OrFailure(Value value) const {
    if (failed()) return failure();
    return value;
  }
  void Refuse(std::string text);

  /// A name of a world or robot.
  std::string Name(std::string_view field, const std::string& value);
  std::string Client(std::string_view field, const std::string& value);
  /// The same, or empty.
  std::string OptionalName(std::string_view field, const std::string& value);
  std::string OptionalClient(std::string_view field, const std::string& value);
  /// 64 lower-case hexadecimal digits, or empty.
  std::string Checksum(std::string_view field, const std::string& value);
  /// Readable(): DDS carries any bytes, protobuf and JSON do not.
  std::string Text(std::string_view field, const std::string& value);
  double Finite(std::string_view field, double value);
  double Range(std::string_view field, double value, double low, double high);
  /// Finite, above 0 and up to `high`.
  void Positive(std::string_view field, double value, double high);
  double Heading(std::string_view field, double value);
  void Size(std::string_view field, std::size_t size, std::size_t limit);
  void AtLeastOne(std::string_view field, std::uint64_t value);
  /// `high` is the last enumerator.
  template <class Enum>
  Enum Enumerator(std::string_view field, std::uint8_t value, Enum low, Enum high) {
    if (value < static_cast<std::uint8_t>(low) || value > static_cast<std::uint8_t>(high)) {
      Refuse(fmt::format("{} = {} is not in [{}, {}]", field, value, static_cast<int>(low),
                         static_cast<int>(high)));
      return low;
    }
    return static_cast<Enum>(value);
  }
  /// The cell lies in a grid of `rows` x `columns`; kMaxSide where no grid is known.
  void Inside(std::string_view field, Cell cell, std::uint32_t rows = kMaxSide,
              std::uint32_t columns = kMaxSide);
  /// The same of `field`[0], `field`[1], ...
  void Inside(std::string_view field, std::span<const Cell> cells, std::uint32_t rows = kMaxSide,
              std::uint32_t columns = kMaxSide);
  /// At most kMaxPath places in the map frame, each within kMaxPosition of its origin.
  void InFrame(std::string_view field, const std::vector<Position>& places);
  /// False when rows or columns are not in [1, kMaxSide].
  bool Shape(std::uint32_t rows, std::uint32_t columns);
  /// rows x columns probabilities in [0, 1]. Requires that Shape() returned true.
  Grid<float> Probabilities(std::string_view field, const std::vector<float>& values, int rows,
                            int columns);

 private:
  std::string Characters(std::string_view field, const std::string& value, std::size_t limit,
                         std::string_view extra);

  std::optional<Error> error_;
};

}  // namespace conav::convert
