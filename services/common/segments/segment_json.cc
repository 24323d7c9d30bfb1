#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "common/runtime/file.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_file.h"

namespace conav {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

/// A rejected line; what() is the reason. ImportSegments turns it into an Error. It is an exception,
/// unlike other foreseen failures, because each of some thirty members of two kinds of lines may be
/// at fault, and no function between it and ImportSegments can act.
class LineRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class... Values>
[[noreturn]] void RefuseLine(fmt::format_string<Values...> text, Values&&... values) {
  throw LineRefused(fmt::format(text, std::forward<Values>(values)...));
}

/// Takes the members of a JSON object one by one, then detects unknown ones. Throws LineRefused.
class JsonFields {
 public:
  /// `name` precedes a key in messages: "", "pose.".
  JsonFields(const Json& object, std::string name) : object_(object), name_(std::move(name)) {
    if (!object.is_object()) RefuseLine("{} is not an object", name_.empty() ? "the line" : name_);
  }

  /// Null for a key that is missing or null.
  const Json* Find(const char* key) {
    asked_.insert(key);
    const auto found = object_.find(key);
    return found == object_.end() || found->is_null() ? nullptr : &*found;
  }
  const Json& Member(const char* key) {
    const Json* member = Find(key);
    if (member == nullptr) RefuseLine("'{}{}' is missing", name_, key);
    return *member;
  }
  std::string Text(const char* key) { return Take<std::string>(key, &Json::is_string, "a text"); }
  double Number(const char* key) { return Take<double>(key, &Json::is_number, "a number"); }
  std::uint64_t Count(const char* key) {
    return Take<std::uint64_t>(key, &Json::is_number_unsigned, "a whole number from 0 on");
  }
  std::uint32_t SmallCount(const char* key) {
    const std::uint64_t count = Count(key);
    if (count > std::numeric_limits<std::uint32_t>::max()) Wrong(key, "below 2^32");
    return static_cast<std::uint32_t>(count);
  }
  bool Flag(const char* key) { return Take<bool>(key, &Json::is_boolean, "true or false"); }

  /// The same, for keys that may be missing or null.
  std::string TextOr(const char* key, std::string otherwise) {
    return Find(key) == nullptr ? otherwise : Text(key);
  }
  std::uint64_t CountOr(const char* key, std::uint64_t otherwise) {
    return Find(key) == nullptr ? otherwise : Count(key);
  }
  std::optional<double> MaybeNumber(const char* key) {
    return Find(key) == nullptr ? std::nullopt : std::optional(Number(key));
  }

  /// For a member that was not taken.
  void RefuseOthers() const {
    for (const auto& [key, value] : object_.items()) {
      if (!asked_.contains(key)) RefuseLine("'{}{}' is not known", name_, key);
    }
  }

 private:
  template <class T>
  T Take(const char* key, bool (Json::*is_right)() const noexcept, const char* wanted) {
    const Json& member = Member(key);
    if (!(member.*is_right)()) Wrong(key, wanted);
    return member.get<T>();
  }
  [[noreturn]] void Wrong(const char* key, const char* wanted) const {
    RefuseLine("'{}{}' is {}; it must be {}", name_, key, object_.at(key).dump(), wanted);
  }

  const Json& object_;
  std::string name_;
  std::set<std::string> asked_;
};

constexpr int kSchema = 1;

// From values to JSON.

std::string Bits(const BeliefGrid& map) {
  std::string bits;
  for (const float value : map.values()) bits += value != 0.0F ? '1' : '0';
  return bits;
}

std::string Bits(const std::vector<Cell>& cells, const BeliefGrid& shape) {
  std::string bits(shape.size(), '0');
  for (const Cell cell : cells) bits[shape.IndexOf(cell)] = '1';
  return bits;
}

std::string Bits(const OccupancyGrid& map) {
  std::string bits;
  for (const Occupancy value : map.values()) {
    bits += value == Occupancy::kUnknown ? '?' : value == Occupancy::kOccupied ? '1' : '0';
  }
  return bits;
}

double ToRadians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// The shortest decimal in degrees that stands for this heading.
double ToDegrees(double radians) {
  const double degrees = radians * 180.0 / std::numbers::pi;
  for (int digits = 1; digits < std::numeric_limits<double>::max_digits10; ++digits) {
    const std::string text = fmt::format("{:.{}g}", degrees, digits);
    double candidate = 0.0;
    std::from_chars(text.data(), text.data() + text.size(), candidate);
    if (ToRadians(candidate) == radians) return candidate;
  }
  return degrees;
}

OrderedJson Pose(const PerceptionQuery& query) {
  OrderedJson pose{{"r", query.cell.row}, {"c", query.cell.column}};
  const double degrees = ToDegrees(query.heading_rad);
  pose["heading_deg"] = degrees;
  if (ToRadians(degrees) != query.heading_rad) pose["heading_rad"] = query.heading_rad;
  return pose;
}

OrderedJson MaybeJson(const std::optional<double>& value) {
  return value ? OrderedJson(*value) : OrderedJson();
}

bool IsValid(const Trajectory& trajectory) {
  return trajectory.final_mapping_accuracy > kAcceptedMappingAccuracy;
}

// From JSON to values.

/// `allowed` lists the characters of the bit string.
const std::string& BitsOf(const Json& member, const char* key, std::size_t size,
                          std::string_view allowed) {
  if (!member.is_string()) RefuseLine("'{}' is not a bit string", key);
  const auto& bits = member.get_ref<const std::string&>();
  if (bits.size() != size) RefuseLine("'{}' has {} bits for {} cells", key, bits.size(), size);
  const std::size_t wrong = bits.find_first_not_of(allowed);
  if (wrong != std::string::npos) RefuseLine("'{}' has a '{}' at {}", key, bits[wrong], wrong);
  return bits;
}

BeliefGrid ToBeliefGrid(JsonFields& line, const char* key, int rows, int columns) {
  BeliefGrid map(rows, columns);
  const std::string& bits = BitsOf(line.Member(key), key, map.size(), "01");
  std::ranges::transform(bits, map.values().begin(),
                         [](char bit) { return bit == '1' ? 1.0F : 0.0F; });
  return map;
}

std::vector<Cell> ToSeenCells(JsonFields& line, const char* key, const BeliefGrid& shape) {
  const std::string& bits = BitsOf(line.Member(key), key, shape.size(), "01");
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i] == '1') cells.push_back(shape.CellAt(i));
  }
  return cells;
}

OccupancyGrid ToTruth(const Json& member, int rows, int columns) {
  OccupancyGrid truth(rows, columns);
  const std::string& bits = BitsOf(member, "truth", truth.size(), "01?");
  std::ranges::transform(bits, truth.values().begin(), [](char bit) {
    return bit == '?' ? Occupancy::kUnknown : bit == '1' ? Occupancy::kOccupied : Occupancy::kFree;
  });
  return truth;
}

int ToIndex(const Json& value, const char* key) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() >= kMaxMapSide) {
    RefuseLine("'{}' has {}, which is not a row or column below {}", key, value.dump(),
               kMaxMapSide);
  }
  return value.get<int>();
}

std::vector<Cell> ToPath(const Json& member) {
  if (!member.is_array()) RefuseLine("'tau' is not a list of [row, column]");
  std::vector<Cell> path;
  for (const Json& cell : member) {
    if (!cell.is_array() || cell.size() != 2) {
      RefuseLine("'tau' has {}, which is not [row, column]", cell.dump());
    }
    path.push_back({ToIndex(cell[0], "tau"), ToIndex(cell[1], "tau")});
  }
  return path;
}

void TakePose(const Json& member, PerceptionQuery& query) {
  JsonFields pose(member, "pose.");
  query.cell = {ToIndex(pose.Member("r"), "pose.r"), ToIndex(pose.Member("c"), "pose.c")};
  query.heading_rad = ToRadians(pose.Number("heading_deg"));
  if (const auto exact = pose.MaybeNumber("heading_rad")) {
    if (std::abs(*exact - query.heading_rad) > 1e-6) {
      RefuseLine("pose: heading_rad {} is not heading_deg", *exact);
    }
    query.heading_rad = *exact;
  }
  pose.RefuseOthers();
}

SegmentOrigin ToOrigin(const std::string& text) {
  for (const SegmentOrigin origin : kSegmentOrigins) {
    if (text == ToText(origin)) return origin;
  }
  RefuseLine("'origin' is '{}'; it must be person, simulated or synthetic", text);
}

int ToSide(JsonFields& line, const char* key) {
  const std::uint64_t side = line.Count(key);
  if (side < kMinMapSide || side > kMaxMapSide) {
    RefuseLine("'{}' is {}; it must be in [{}, {}]", key, side, kMinMapSide, kMaxMapSide);
  }
  return static_cast<int>(side);
}

std::map<std::string, double> ToParameters(const Json* member) {
  std::map<std::string, double> parameters;
  if (member == nullptr) return parameters;
  JsonFields fields(*member, "annotator.");
  for (const auto& [name, value] : member->items()) parameters[name] = fields.Number(name.c_str());
  return parameters;
}

void CheckSchema(JsonFields& line) {
  const std::uint64_t schema = line.Count("schema");
  if (schema != kSchema) RefuseLine("schema {}; this program reads {}", schema, kSchema);
}

std::uint64_t EditCount(const Trajectory& trajectory) {
  std::uint64_t edits = 0;
  for (const Segment& segment : trajectory.segments) {
    edits += static_cast<std::uint64_t>(EditCount(segment));
  }
  return edits;
}

OrderedJson ToLine(const Trajectory& trajectory) {
  const BeliefGrid& shape = trajectory.segments.front().query.belief;
  return {{"type", "trajectory"},
          {"schema", kSchema},
          {"origin", ToText(trajectory.origin)},
          {"participant", trajectory.participant},
          {"session", trajectory.session},
          {"world", trajectory.world},
          {"world_seed", trajectory.world_seed},
          {"corruption_seed", trajectory.corruption_seed},
          {"rows", shape.rows()},
          {"columns", shape.columns()},
          {"truth", trajectory.truth ? OrderedJson(Bits(*trajectory.truth)) : OrderedJson()},
          {"initial_cell_accuracy", trajectory.initial_cell_accuracy},
          {"final_cell_accuracy", trajectory.final_cell_accuracy},
          {"final_mapping_accuracy", trajectory.final_mapping_accuracy},
          {"valid", IsValid(trajectory)},
          {"edits", EditCount(trajectory)},
          {"annotator", OrderedJson(trajectory.annotator)},
          {"annotator_seed", trajectory.annotator_seed}};
}

OrderedJson ToLine(const Segment& segment) {
  const PerceptionQuery& query = segment.query;
  OrderedJson path = OrderedJson::array();
  for (const Cell cell : query.path) path.push_back({cell.row, cell.column});
  return {{"type", "segment"},
          {"step", segment.step},
          {"x", Bits(query.belief)},
          {"tau", path},
          {"pose", Pose(query)},
          {"o_free", Bits(query.visible.free, query.belief)},
          {"o_wall", Bits(query.visible.walls, query.belief)},
          {"x_next", Bits(segment.belief_after)},
          {"image", segment.image},
          {"image_sha256", segment.image_sha256},
          {"sent_s", MaybeJson(segment.sent_s)},
          {"first_edit_s", MaybeJson(segment.first_edit_s)},
          {"confirmed_s", MaybeJson(segment.confirmed_s)},
          {"goals_reached", segment.goals_reached}};
}

/// A trajectory's line, including its statements about the segments.
struct TrajectoryLine {
  Trajectory trajectory;  // without segments
  int rows = 0;
  int columns = 0;
  std::optional<std::uint64_t> edits;
};

TrajectoryLine ToTrajectory(JsonFields& line) {
  CheckSchema(line);
  TrajectoryLine read;
  Trajectory& trajectory = read.trajectory;
  read.rows = ToSide(line, "rows");
  read.columns = ToSide(line, "columns");
  trajectory.origin = ToOrigin(line.Text("origin"));
  trajectory.participant = line.TextOr("participant", "");
  trajectory.session = line.TextOr("session", "");
  trajectory.world = line.TextOr("world", "");
  trajectory.world_seed = line.CountOr("world_seed", 0);
  trajectory.corruption_seed = line.CountOr("corruption_seed", 0);
  if (const Json* truth = line.Find("truth")) {
    trajectory.truth = ToTruth(*truth, read.rows, read.columns);
  }
  const auto accuracy = [&](const char* key) {
    return trajectory.truth ? line.Number(key) : line.MaybeNumber(key).value_or(0.0);
  };
  trajectory.initial_cell_accuracy = accuracy("initial_cell_accuracy");
  trajectory.final_cell_accuracy = accuracy("final_cell_accuracy");
  trajectory.final_mapping_accuracy = accuracy("final_mapping_accuracy");
  trajectory.annotator = ToParameters(line.Find("annotator"));
  trajectory.annotator_seed = line.CountOr("annotator_seed", 0);
  if (line.Find("valid") != nullptr && line.Flag("valid") != IsValid(trajectory)) {
    RefuseLine("'valid' is {}, but final_mapping_accuracy is {}", !IsValid(trajectory),
               trajectory.final_mapping_accuracy);
  }
  if (line.Find("edits") != nullptr) read.edits = line.Count("edits");
  return read;
}

Segment ToSegment(JsonFields& line, int rows, int columns) {
  Segment segment;
  PerceptionQuery& query = segment.query;
  segment.step = line.SmallCount("step");
  query.belief = ToBeliefGrid(line, "x", rows, columns);
  segment.belief_after = ToBeliefGrid(line, "x_next", rows, columns);
  query.path = ToPath(line.Member("tau"));
  TakePose(line.Member("pose"), query);
  query.visible.free = ToSeenCells(line, "o_free", query.belief);
  query.visible.walls = ToSeenCells(line, "o_wall", query.belief);
  segment.image = line.TextOr("image", "");
  segment.image_sha256 = line.TextOr("image_sha256", "");
  segment.sent_s = line.MaybeNumber("sent_s");
  segment.first_edit_s = line.MaybeNumber("first_edit_s");
  segment.confirmed_s = line.MaybeNumber("confirmed_s");
  if (line.Find("goals_reached") != nullptr)
    segment.goals_reached = line.SmallCount("goals_reached");
  return segment;
}

constexpr std::size_t kMaxLineBytes = std::size_t{64} * 1024 * 1024;
constexpr std::string_view kZstdMagic = "\x28\xb5\x2f\xfd";

/// The parser's reason without its quotation, which may be the whole line, plus the text at that
/// place.
std::string ParseProblem(const std::string& text, const Json::parse_error& error) {
  constexpr std::size_t kShown = 20;
  const std::string problem = error.what();
  const std::size_t reason = problem.find(" - ");
  const std::size_t end = std::min(error.byte, text.size());
  const std::size_t begin = end - std::min(end, kShown);
  return fmt::format("this is not JSON: byte {}, after '{}': {}", error.byte,
                     text.substr(begin, end - begin),
                     reason == std::string::npos
                         ? "syntax error"
                         : problem.substr(reason + 3, problem.find(';', reason) - reason - 3));
}

Json Parse(const std::string& text) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw LineRefused(ParseProblem(text, error));
  } catch (const Json::out_of_range& error) {
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
    const Json parsed = Parse(text);
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
