#include "common/segments/segment_file.h"

#include <fmt/core.h>
#include <segments.pb.h>

#include <array>

#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "common/segments/record_stream.h"
#include "common/segments/segment_checks.h"

namespace conav {
namespace {

// In the order of the values of segments::Map::cells.
constexpr std::array kOccupancies{Occupancy::kFree, Occupancy::kOccupied, Occupancy::kUnknown};

using Indices = google::protobuf::RepeatedField<std::uint32_t>;

// From values to records.

template <class T, class ToByte>
void Fill(segments::Map& record, const Grid<T>& map, ToByte&& to_byte) {
  record.set_rows(static_cast<std::uint32_t>(map.rows()));
  record.set_columns(static_cast<std::uint32_t>(map.columns()));
  std::string& cells = *record.mutable_cells();
  cells.reserve(map.size());
  for (const T value : map.values()) cells.push_back(static_cast<char>(to_byte(value)));
}

void Fill(segments::Map& record, const BeliefGrid& map) {
  Fill(record, map, [](float value) { return value != 0.0F ? 1 : 0; });
}

void Fill(segments::Map& record, const OccupancyGrid& map) {
  Fill(record, map, [](Occupancy value) {
    return std::ranges::find(kOccupancies, value) - kOccupancies.begin();
  });
}

void Fill(Indices& record, const std::vector<Cell>& cells, const BeliefGrid& map) {
  record.Reserve(static_cast<int>(cells.size()));
  for (const Cell cell : cells) record.Add(static_cast<std::uint32_t>(map.IndexOf(cell)));
}

// From records to values.

/// Call before allocating the map.
Result<void> CheckSize(const segments::Map& record, const char* what) {
  constexpr auto kLimit = static_cast<std::uint32_t>(kMaxMapSide);
  if (record.rows() == 0 || record.columns() == 0 || record.rows() > kLimit ||
      record.columns() > kLimit) {
    return Malformed("{} is {} x {}; each side must be in [1, {}]", what, record.rows(),
                     record.columns(), kLimit);
  }
  const std::size_t size = std::size_t{record.rows()} * record.columns();
  if (record.cells().size() == size) return {};
  return Malformed("{} has {} values for {} x {} cells", what, record.cells().size(), record.rows(),
                   record.columns());
}

template <class T, class FromByte>
Result<Grid<T>> ToGrid(const segments::Map& record, int highest, const char* what,
                       FromByte&& from_byte) {
  if (const auto sized = CheckSize(record, what); !sized) return tl::unexpected(sized.error());
  Grid<T> map(static_cast<int>(record.rows()), static_cast<int>(record.columns()));
  for (std::size_t i = 0; i < map.size(); ++i) {
    const int value = static_cast<unsigned char>(record.cells()[i]);
    if (value > highest) {
      return Malformed("{} is {} at {}; it must be at most {}", what, value, map.CellAt(i),
                       highest);
    }
    map.values()[i] = from_byte(value);
  }
  return map;
}

Result<BeliefGrid> ToBeliefGrid(const segments::Map& record, const char* what) {
  return ToGrid<float>(record, 1, what, [](int value) { return static_cast<float>(value); });
}

Result<std::vector<Cell>> ToCells(const Indices& record, const BeliefGrid& map, const char* what) {
  std::vector<Cell> cells;
  cells.reserve(static_cast<std::size_t>(record.size()));
  for (const std::uint32_t index : record) {
    if (index >= map.size()) {
      return Malformed("{} cell {} is outside of the {} x {} map", what, index, map.rows(),
                       map.columns());
    }
    cells.push_back(map.CellAt(index));
  }
  return cells;
}

std::optional<double> Optional(bool present, double value) {
  return present ? std::optional(value) : std::nullopt;
}

// From records to a set.

/// Assembles records into a set.
class Assembly {
 public:
  Result<void> Add(const segments::Record& record) {
    if (record.has_header()) return AddHeader(record.header());
    if (!has_header_)
      return Malformed("it does not begin with a header: this is not a segment file");
    if (record.has_trajectory()) return AddTrajectory(record.trajectory());
    if (record.has_segment()) return AddSegment(record.segment());
    return Malformed("a record is neither header nor trajectory nor segment");
  }

  Result<SegmentSet> Finish() {
    if (!has_header_) return Malformed("it has no header: this is not a segment file");
    return CheckSegments(set_).map([this] { return std::move(set_); });
  }

 private:
  Result<void> AddHeader(const segments::Header& record) {
    has_header_ = true;
    if (record.schema_version() == kSegmentSchemaVersion) return {};
    return Malformed("schema version {}; this program reads {}", record.schema_version(),
                     kSegmentSchemaVersion);
  }

  Result<void> AddTrajectory(const segments::Trajectory& record) {
    const std::size_t number = record.number();
    if (number > set_.trajectories.size()) {
      return Malformed("trajectory {} comes before trajectory {}", number,
                       set_.trajectories.size());
    }
    auto trajectory = ToDomain(record);
    if (!trajectory) {
      return Malformed("trajectory {}: {}", number, trajectory.error().text);
    }
    if (number == set_.trajectories.size()) set_.trajectories.emplace_back();
    Trajectory& kept = set_.trajectories[number];
    trajectory->segments = std::move(kept.segments);
    kept = *std::move(trajectory);
    return {};
  }

  Result<void> AddSegment(const segments::Segment& record) {
    const std::size_t number = record.trajectory();
    if (number >= set_.trajectories.size()) {
      return Malformed("a segment of trajectory {}, which has no record before it", number);
    }
    std::vector<Segment>& segments = set_.trajectories[number].segments;
    auto segment = ToDomain(record);
    if (!segment) {
      return Malformed("{}: {}", SegmentPlace(number, segments.size()), segment.error().text);
    }
    segments.push_back(*std::move(segment));
    return {};
  }

  SegmentSet set_;
  bool has_header_ = false;
};

Result<SegmentSet> ReadRecords(std::string_view frames) {
  RecordReader reader(frames, "segment file");
  Assembly assembly;
  segments::Record record;
  while (true) {
    const auto more = reader.Next(record);
    if (!more) return tl::unexpected(more.error());
    if (!*more) return assembly.Finish();
    if (const auto added = assembly.Add(record); !added) return tl::unexpected(added.error());
  }
}

Result<SegmentSet> ReadFrames(std::string_view file, TornEnd torn_end) {
  if (file.empty()) return Malformed("it is empty");
  const auto frames = FindFrames(file);
  if (!frames) return tl::unexpected(frames.error());
  if (frames->torn && torn_end == TornEnd::kRefuse) {
    return Malformed("it is truncated: its {} bytes end inside a zstd frame{}", file.size(),
                     frames->complete_bytes == 0
                         ? std::string()
                         : fmt::format("; {} bytes before it are complete (--recover keeps them)",
                                       frames->complete_bytes));
  }
  if (frames->complete_bytes == 0) return Malformed("it has no complete zstd frame");
  return ReadRecords(file.substr(0, frames->complete_bytes));
}

Result<SegmentSet> ReadBytes(const std::filesystem::path& path, std::string_view file,
                             TornEnd torn_end) {
  return ReadFrames(file, torn_end).map_error([&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", path.string(), error.text)};
  });
}

}  // namespace

segments::Record HeaderRecord() {
  segments::Record record;
  record.mutable_header()->set_schema_version(kSegmentSchemaVersion);
  return record;
}

segments::Record ToRecord(const Trajectory& trajectory, std::uint32_t number) {
  segments::Record whole;
  segments::Trajectory& record = *whole.mutable_trajectory();
  record.set_number(number);
  record.set_origin(static_cast<segments::Origin>(static_cast<int>(trajectory.origin) + 1));
  record.set_participant(trajectory.participant);
  record.set_session(trajectory.session);
  record.set_world(trajectory.world);
  record.set_world_seed(trajectory.world_seed);
  record.set_corruption_seed(trajectory.corruption_seed);
  if (trajectory.truth) Fill(*record.mutable_truth(), *trajectory.truth);
  record.set_initial_cell_accuracy(trajectory.initial_cell_accuracy);
  record.set_final_cell_accuracy(trajectory.final_cell_accuracy);
  record.set_final_mapping_accuracy(trajectory.final_mapping_accuracy);
  for (const auto& [name, value] : trajectory.annotator) {
    (*record.mutable_annotator())[name] = value;
  }
  record.set_annotator_seed(trajectory.annotator_seed);
  return whole;
}

segments::Record ToRecord(const Segment& segment, std::uint32_t trajectory) {
  segments::Record whole;
  segments::Segment& record = *whole.mutable_segment();
  const PerceptionQuery& query = segment.query;
  record.set_trajectory(trajectory);
  record.set_step(segment.step);
  Fill(*record.mutable_map_before(), query.belief);
  Fill(*record.mutable_map_after(), segment.belief_after);
  Fill(*record.mutable_path(), query.path, query.belief);
  record.set_camera_cell(static_cast<std::uint32_t>(query.belief.IndexOf(query.cell)));
  record.set_heading(query.heading_rad);
  Fill(*record.mutable_free_cells(), query.visible.free, query.belief);
  Fill(*record.mutable_wall_cells(), query.visible.walls, query.belief);
  record.set_image(segment.image);
  record.set_image_sha256(segment.image_sha256);
  if (segment.sent_s) record.set_sent(*segment.sent_s);
  if (segment.first_edit_s) record.set_first_edit(*segment.first_edit_s);
  if (segment.confirmed_s) record.set_confirmed(*segment.confirmed_s);
  record.set_goals_reached(segment.goals_reached);
  return whole;
}

Result<Trajectory> ToDomain(const segments::Trajectory& record) {
  Trajectory trajectory;
  const auto origin = static_cast<std::size_t>(record.origin()) - 1;  // 0 wraps around
  if (origin >= kSegmentOrigins.size()) {
    return Malformed("origin {} is not known", static_cast<int>(record.origin()));
  }
  trajectory.origin = kSegmentOrigins[origin];
  trajectory.participant = record.participant();
  trajectory.session = record.session();
  trajectory.world = record.world();
  trajectory.world_seed = record.world_seed();
  trajectory.corruption_seed = record.corruption_seed();
  if (record.has_truth()) {
    auto truth = ToGrid<Occupancy>(record.truth(), 2, "the truth", [](int value) {
      return kOccupancies[static_cast<std::size_t>(value)];
    });
    if (!truth) return tl::unexpected(truth.error());
    trajectory.truth = *std::move(truth);
  }
  trajectory.initial_cell_accuracy = record.initial_cell_accuracy();
  trajectory.final_cell_accuracy = record.final_cell_accuracy();
  trajectory.final_mapping_accuracy = record.final_mapping_accuracy();
  trajectory.annotator = {record.annotator().begin(), record.annotator().end()};
  trajectory.annotator_seed = record.annotator_seed();
  return trajectory;
}

Result<Segment> ToDomain(const segments::Segment& record) {
  Segment segment;
  PerceptionQuery& query = segment.query;
  const auto take = [](auto result, auto& target) -> Result<void> {
    if (!result) return tl::unexpected(result.error());
    target = *std::move(result);
    return {};
  };
  segment.step = record.step();
  query.heading_rad = record.heading();
  segment.image = record.image();
  segment.image_sha256 = record.image_sha256();
  segment.sent_s = Optional(record.has_sent(), record.sent());
  segment.first_edit_s = Optional(record.has_first_edit(), record.first_edit());
  segment.confirmed_s = Optional(record.has_confirmed(), record.confirmed());
  segment.goals_reached = record.goals_reached();
  std::vector<Cell> camera;
  Indices camera_cell;
  camera_cell.Add(record.camera_cell());
  return take(ToBeliefGrid(record.map_before(), "x"), query.belief)
      .and_then([&] { return take(ToBeliefGrid(record.map_after(), "x'"), segment.belief_after); })
      .and_then([&] { return take(ToCells(record.path(), query.belief, "path"), query.path); })
      .and_then([&] { return take(ToCells(camera_cell, query.belief, "camera"), camera); })
      .and_then([&] {
        return take(ToCells(record.free_cells(), query.belief, "seen free"), query.visible.free);
      })
      .and_then([&] {
        return take(ToCells(record.wall_cells(), query.belief, "seen wall"), query.visible.walls);
      })
      .map([&] {
        query.cell = camera.front();
        return std::move(segment);
      });
}

Result<void> WriteSegmentFile(const std::filesystem::path& path, const SegmentSet& set) {
  if (const auto checked = CheckSegments(set); !checked) {
    return Fail(checked.error().code, fmt::format("{}: {}", path.string(), checked.error().text));
  }
  ZstdFrame frame;
  frame.Add(Delimited(HeaderRecord()));
  std::uint32_t number = 0;
  for (const Trajectory& trajectory : set.trajectories) {
    frame.Add(Delimited(ToRecord(trajectory, number)));
    for (const Segment& segment : trajectory.segments) {
      frame.Add(Delimited(ToRecord(segment, number)));
    }
    ++number;
  }
  return WriteFile(path, frame.Finish());
}

Result<SegmentSet> ReadSegmentFile(const std::filesystem::path& path, TornEnd torn_end) {
  const auto file = ReadFile(path);
  if (!file) return tl::unexpected(file.error());
  return ReadBytes(path, *file, torn_end);
}

Result<IdentifiedSegments> ReadIdentifiedSegments(const std::filesystem::path& path) {
  const auto file = ReadFile(path);
  if (!file) return tl::unexpected(file.error());
  return ReadBytes(path, *file, TornEnd::kRefuse).map([&](SegmentSet&& set) {
    return IdentifiedSegments{std::move(set), Sha256Hex(*file)};
  });
}

}  // namespace conav
