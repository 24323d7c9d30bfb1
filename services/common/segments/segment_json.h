#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "common/grid/grid.h"
#include "common/runtime/result.h"
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

/// Segments as JSON lines, for people who work in Python. One line for a trajectory, then one for
/// each of its segments:
///
///   {"type": "trajectory", "schema": 1, "origin": "person", "participant": "p07", "session":
///   "...",
///    "world": "conav13", "world_seed": 7, "corruption_seed": 7, "rows": 15, "columns": 15,
///    "truth": "1110..." or null, "initial_cell_accuracy": 0.88, "final_cell_accuracy": 0.96,
///    "final_mapping_accuracy": 0.7, "valid": true, "edits": 17, "annotator": {}, "annotator_seed":
///    0}
///   {"type": "segment", "step": 0, "x": "1110...", "tau": [[1, 1], [1, 2]],
///    "pose": {"r": 1, "c": 2, "heading_deg": 90.0}, "o_free": "0110...", "o_wall": "1001...",
///    "x_next": "1110...", "image": "", "image_sha256": "", "sent_s": 3.5, "first_edit_s": null,
///    "confirmed_s": 9.25, "goals_reached": 1}
///
/// Bit strings are row-major from the northern row, 1 = wall (seen, for o_free and o_wall); in
/// `truth` a `?` is unknown. Headings: 0 = east, counter-clockwise. If the degrees do not give the
/// exact number, "heading_rad" accompanies "heading_deg" and takes precedence. `valid` (final
/// mapping accuracy above 0.5) and `edits` follow from the rest: they are optional, and rejected if
/// they contradict it. Without a truth the accuracies may be null or missing, and are 0. Source:
/// paper Appendix A, (x, tau, o, x').
namespace conav {

/// All lines. Importing them gives the same set back. Requires CheckSegments(set).
void ExportSegments(const SegmentSet& set, std::ostream& out);

/// Reads the lines of `in` and skips empty ones. Errors: kMalformed with "name:line: " and reason
/// (not JSON, an unknown or missing key or one of a wrong type, a segment before any trajectory,
/// another schema, a bit string of another length, CheckSegments).
[[nodiscard]] Result<SegmentSet> ImportSegments(std::istream& in, const std::string& name);

/// The same for a file. Errors also: kNotFound, kIo.
[[nodiscard]] Result<SegmentSet> ImportSegmentsFile(const std::filesystem::path& path);

/// Writes as WriteFile does. Errors: kMalformed (CheckSegments), kIo.
[[nodiscard]] Result<void> ExportSegmentsFile(const std::filesystem::path& path,
                                              const SegmentSet& set);

}  // namespace conav
