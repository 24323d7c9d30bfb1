#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/segments/segment_checks.h"
#include "common/segments/segment_json.h"

namespace conav {

JsonFields::JsonFields(const nlohmann::json& object, std::string name)
    : object_(object), name_(std::move(name)) {
  if (!object.is_object()) RefuseLine("{} is not an object", name_.empty() ? "the line" : name_);
}

const nlohmann::json* JsonFields::Find(const char* key) {
  asked_.insert(key);
  const auto found = object_.find(key);
  return found == object_.end() || found->is_null() ? nullptr : &*found;
}

const nlohmann::json& JsonFields::Member(const char* key) {
  const nlohmann::json* member = Find(key);
  if (member == nullptr) RefuseLine("'{}{}' is missing", name_, key);
  return *member;
}

void JsonFields::Wrong(const char* key, const char* wanted) const {
  RefuseLine("'{}{}' is {}; it must be {}", name_, key, object_.at(key).dump(), wanted);
}

std::string JsonFields::Text(const char* key) {
  const nlohmann::json& member = Member(key);
  if (!member.is_string()) Wrong(key, "a text");
  return member.get<std::string>();
}

double JsonFields::Number(const char* key) {
  const nlohmann::json& member = Member(key);
  if (!member.is_number()) Wrong(key, "a number");
  return member.get<double>();
}

std::uint64_t JsonFields::Count(const char* key) {
  const nlohmann::json& member = Member(key);
  if (!member.is_number_unsigned()) Wrong(key, "a whole number from 0 on");
  return member.get<std::uint64_t>();
}

std::uint32_t JsonFields::SmallCount(const char* key) {
  const std::uint64_t count = Count(key);
  if (count > std::numeric_limits<std::uint32_t>::max()) Wrong(key, "below 2^32");
  return static_cast<std::uint32_t>(count);
}

std::string JsonFields::TextOr(const char* key, std::string otherwise) {
  return Find(key) == nullptr ? otherwise : Text(key);
}

std::uint64_t JsonFields::CountOr(const char* key, std::uint64_t otherwise) {
  return Find(key) == nullptr ? otherwise : Count(key);
}

std::optional<double> JsonFields::MaybeNumber(const char* key) {
  return Find(key) == nullptr ? std::nullopt : std::optional(Number(key));
}

std::optional<bool> JsonFields::MaybeFlag(const char* key) {
  const nlohmann::json* member = Find(key);
  if (member == nullptr) return std::nullopt;
  if (!member->is_boolean()) Wrong(key, "true or false");
  return member->get<bool>();
}

void JsonFields::RefuseOthers() const {
  for (const auto& [key, value] : object_.items()) {
    if (!asked_.contains(key)) RefuseLine("'{}{}' is not known", name_, key);
  }
}

namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr int kSchema = 1;
constexpr std::array kOrigins{SegmentOrigin::kPerson, SegmentOrigin::kSimulated,
                              SegmentOrigin::kSynthetic};

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
  for (const SegmentOrigin origin : kOrigins) {
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

}  // namespace

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
  if (const auto valid = line.MaybeFlag("valid"); valid && *valid != IsValid(trajectory)) {
    RefuseLine("'valid' is {}, but final_mapping_accuracy is {}", *valid,
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

}  // namespace conav
