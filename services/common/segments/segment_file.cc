#include "common/segments/segment_file.h"

#include <fmt/format.h>

#include "common/runtime/file.h"
#include "common/runtime/sha256.h"
#include "common/segments/record_stream.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_records.h"

namespace conav {
namespace {

tl::unexpected<Error> Refuse(const std::string& reason) {
  return Fail(ErrorCode::kMalformed, reason);
}

/// Puts records together to a set.
class Assembly {
 public:
  Result<void> Add(const segments::Record& record) {
    if (record.has_header()) return AddHeader(record.header());
    if (!has_header_) return Refuse("it does not begin with a header: this is no segment file");
    if (record.has_trajectory()) return AddTrajectory(record.trajectory());
    if (record.has_segment()) return AddSegment(record.segment());
    return Refuse("a record is neither header nor trajectory nor segment");
  }

  Result<SegmentSet> Finish() {
    if (!has_header_) return Refuse("it has no header: this is no segment file");
    return CheckSegments(set_).map([this] { return std::move(set_); });
  }

 private:
  Result<void> AddHeader(const segments::Header& record) {
    has_header_ = true;
    if (record.schema_version() == kSegmentSchemaVersion) return {};
    return Refuse(fmt::format("schema version {}; this program reads {}", record.schema_version(),
                              kSegmentSchemaVersion));
  }

  Result<void> AddTrajectory(const segments::Trajectory& record) {
    const std::size_t number = record.number();
    if (number > set_.trajectories.size()) {
      return Refuse(fmt::format("trajectory {} comes before trajectory {}", number,
                                set_.trajectories.size()));
    }
    auto trajectory = ToDomain(record);
    if (!trajectory) {
      return Refuse(fmt::format("trajectory {}: {}", number, trajectory.error().text));
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
      return Refuse(fmt::format("a segment of trajectory {}, of which nothing was said", number));
    }
    std::vector<Segment>& segments = set_.trajectories[number].segments;
    auto segment = ToDomain(record);
    if (!segment) {
      return Refuse(SegmentPlace(number, segments.size()) + ": " + segment.error().text);
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
  if (file.empty()) return Refuse("it is empty");
  const auto frames = FindFrames(file);
  if (!frames) return tl::unexpected(frames.error());
  if (frames->torn && torn_end == TornEnd::kRefuse) {
    return Refuse(
        fmt::format("it is truncated: {} bytes end inside of a zstd frame{}", file.size(),
                    frames->complete_bytes == 0
                        ? std::string()
                        : fmt::format("; {} bytes before it are complete (--recover keeps them)",
                                      frames->complete_bytes)));
  }
  if (frames->complete_bytes == 0) return Refuse("it has no complete zstd frame");
  return ReadRecords(file.substr(0, frames->complete_bytes));
}

Result<SegmentSet> ReadBytes(const std::filesystem::path& path, std::string_view file,
                             TornEnd torn_end) {
  return ReadFrames(file, torn_end).map_error([&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", path.string(), error.text)};
  });
}

}  // namespace

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
