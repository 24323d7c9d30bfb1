#include "common/segments/segment_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>

#include "common/runtime/file.h"
#include "common/segments/segment_checks.h"

namespace conav {
namespace {

constexpr std::size_t kMaxLineBytes = std::size_t{64} * 1024 * 1024;
constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";

/// The parser's reason without its quotation, which may be the whole line, plus the text at that
/// place.
std::string ParseProblem(const std::string& text, const nlohmann::json::parse_error& error) {
  constexpr std::size_t kShown = 20;
  const std::string said = error.what();
  const std::size_t reason = said.find(" - ");
  const std::size_t end = std::min(error.byte, text.size());
  const std::size_t begin = end - std::min(end, kShown);
  return fmt::format(
      "this is not JSON: byte {}, after '{}': {}", error.byte, text.substr(begin, end - begin),
      reason == std::string::npos ? "syntax error"
                                  : said.substr(reason + 3, said.find(';', reason) - reason - 3));
}

nlohmann::json Parse(const std::string& text) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw LineRefused(ParseProblem(text, error));
  } catch (const nlohmann::json::out_of_range& error) {
    RefuseLine("this is not JSON: {}", error.what());  // a number
  }
}

/// Assembles lines into a set; throws LineRefused.
class Import {
 public:
  void AddLine(const std::string& text) {
    if (text.size() > kMaxLineBytes) {
      RefuseLine("the line has {} bytes; {} is the limit", text.size(), kMaxLineBytes);
    }
    const nlohmann::json parsed = Parse(text);
    JsonFields line(parsed, "");
    const std::string type = line.Text("type");
    if (type == "trajectory") {
      AddTrajectory(line);
    } else if (type == "segment") {
      AddSegment(line);
    } else {
      RefuseLine("'type' is '{}'; it must be trajectory or segment", type);
    }
    line.RefuseOthers();
  }

  /// Also called before the next trajectory begins.
  void EndTrajectory() {
    if (set_.trajectories.empty()) return;
    const Trajectory& trajectory = set_.trajectories.back();
    if (trajectory.segments.empty()) RefuseLine("the previous trajectory has no segments");
    if (current_.edits && *current_.edits != EditCount(trajectory)) {
      RefuseLine("the previous trajectory has {} edits, but states {}", EditCount(trajectory),
                 *current_.edits);
    }
  }

  SegmentSet Take() { return std::move(set_); }

 private:
  static void RefuseUnless(const Result<void>& checked) {
    if (!checked) throw LineRefused(checked.error().text);
  }

  void AddTrajectory(JsonFields& line) {
    EndTrajectory();
    current_ = ToTrajectory(line);
    RefuseUnless(CheckTrajectoryFacts(current_.trajectory));
    set_.trajectories.push_back(std::move(current_.trajectory));
  }

  void AddSegment(JsonFields& line) {
    if (set_.trajectories.empty()) RefuseLine("a segment before any trajectory");
    Trajectory& trajectory = set_.trajectories.back();
    std::vector<Segment>& segments = trajectory.segments;
    Segment segment = ToSegment(line, current_.rows, current_.columns);
    RefuseUnless(CheckSegment(segment));
    RefuseUnless(
        CheckNextSegment(trajectory.truth, segments.empty() ? nullptr : &segments.back(), segment));
    segments.push_back(std::move(segment));
  }

  SegmentSet set_;
  TrajectoryLine current_;  // of the last trajectory
};

}  // namespace

void ExportSegments(const SegmentSet& set, std::ostream& out) {
  for (const Trajectory& trajectory : set.trajectories) {
    out << ToLine(trajectory).dump() << '\n';
    for (const Segment& segment : trajectory.segments) out << ToLine(segment).dump() << '\n';
  }
}

Result<SegmentSet> ImportSegments(std::istream& in, const std::string& name) {
  Import import;
  std::size_t number = 0;
  try {
    for (std::string line; std::getline(in, line);) {
      ++number;
      if (line.find_first_not_of(" \t\r") != std::string::npos) import.AddLine(line);
    }
    import.EndTrajectory();
  } catch (const LineRefused& refused) {
    return Fail(ErrorCode::kMalformed, fmt::format("{}:{}: {}", name, number, refused.what()));
  }
  if (in.bad()) return Fail(ErrorCode::kIo, fmt::format("{}: cannot read", name));
  return import.Take();
}

Result<SegmentSet> ImportSegmentsFile(const std::filesystem::path& path) {
  auto text = ReadFile(path);
  if (!text) return tl::unexpected(text.error());
  if (text->starts_with(kZstdMagic)) {
    return Fail(ErrorCode::kMalformed, fmt::format("{}: this is not JSON lines; it is compressed, "
                                                   "like a segment file, which needs no import",
                                                   path.string()));
  }
  std::istringstream in(*std::move(text));
  return ImportSegments(in, path.string());
}

Result<void> ExportSegmentsFile(const std::filesystem::path& path, const SegmentSet& set) {
  if (const auto checked = CheckSegments(set); !checked) {
    return Fail(checked.error().code, fmt::format("{}: {}", path.string(), checked.error().text));
  }
  std::ostringstream out;
  ExportSegments(set, out);
  return WriteFile(path, out.str());
}

}  // namespace conav
