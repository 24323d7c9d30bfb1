#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "common/grid/grid.h"
#include "common/segments/segment.h"

/// Converts between one JSON line of segment_json.h and one value.
namespace conav {

/// A rejected line; what() is the reason. Stays in this folder: ImportSegments turns it into an
/// Error. It is an exception, unlike other foreseen failures, because each of some thirty members
/// of two kinds of lines may be at fault, and no function between it and ImportSegments can act.
class LineRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class... Values>
[[noreturn]] void RefuseLine(fmt::format_string<Values...> text, Values&&... values) {
  throw LineRefused(fmt::format(text, std::forward<Values>(values)...));
}

/// Takes the members of a JSON object one by one, then detects unknown ones.
class JsonFields {
 public:
  /// `name` precedes a key in messages: "", "pose.".
  JsonFields(const nlohmann::json& object, std::string name);

  /// Throw LineRefused: missing, of another type.
  std::string Text(const char* key);
  double Number(const char* key);
  std::uint64_t Count(const char* key);
  std::uint32_t SmallCount(const char* key);
  const nlohmann::json& Member(const char* key);

  /// The same, for keys that may be missing or null.
  const nlohmann::json* Find(const char* key);
  std::string TextOr(const char* key, std::string otherwise);
  std::uint64_t CountOr(const char* key, std::uint64_t otherwise);
  std::optional<double> MaybeNumber(const char* key);
  std::optional<bool> MaybeFlag(const char* key);

  /// Throws LineRefused for a member that was not taken.
  void RefuseOthers() const;

 private:
  [[noreturn]] void Wrong(const char* key, const char* wanted) const;

  const nlohmann::json& object_;
  std::string name_;
  std::set<std::string> asked_;
};

nlohmann::ordered_json ToLine(const Trajectory& trajectory);
nlohmann::ordered_json ToLine(const Segment& segment);

/// A trajectory's line, including its statements about the segments.
struct TrajectoryLine {
  Trajectory trajectory;  // without segments
  int rows = 0;
  int columns = 0;
  std::optional<std::uint64_t> edits;
};

/// Throw LineRefused.
TrajectoryLine ToTrajectory(JsonFields& line);
Segment ToSegment(JsonFields& line, int rows, int columns);

/// Number of edited cells over all segments.
std::uint64_t EditCount(const Trajectory& trajectory);

}  // namespace conav
