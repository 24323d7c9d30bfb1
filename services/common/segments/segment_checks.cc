#include "common/segments/segment_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "common/runtime/text.h"

namespace conav {
namespace {

constexpr std::size_t kSha256Digits = 64;
constexpr double kMaxHeading = 1e6;  // rad; robots may turn many times

template <class T>
Result<void> CheckSides(const Grid<T>& map, const char* what) {
  const auto fits = [](int side) { return side >= kMinMapSide && side <= kMaxMapSide; };
  if (fits(map.rows()) && fits(map.columns())) return {};
  return Malformed("{} is {} x {}; each side must be in [{}, {}]", what, map.rows(), map.columns(),
                   kMinMapSide, kMaxMapSide);
}

template <class A, class B>
Result<void> CheckSameShape(const Grid<A>& map, const Grid<B>& other, const char* what,
                            const char* other_what) {
  if (map.rows() == other.rows() && map.columns() == other.columns()) return {};
  return Malformed("{} is {} x {}, but {} is {} x {}", what, map.rows(), map.columns(), other_what,
                   other.rows(), other.columns());
}

Result<void> CheckValues(const BeliefGrid& map, const char* what) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    const float value = map.values()[i];
    if (value == 0.0F || value == 1.0F) continue;
    return Malformed("{} is {} at {}; it must be 0 or 1", what, value, map.CellAt(i));
  }
  return {};
}

Result<void> CheckMaps(const Segment& segment) {
  const BeliefGrid& before = segment.query.belief;
  const BeliefGrid& after = segment.belief_after;
  return CheckSides(before, "x")
      .and_then([&] { return CheckSameShape(after, before, "x'", "x"); })
      .and_then([&] { return CheckValues(before, "x"); })
      .and_then([&] { return CheckValues(after, "x'"); });
}

Result<void> CheckBorder(const Segment& segment) {
  const BeliefGrid& before = segment.query.belief;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Cell cell = before.CellAt(i);
    if (!before.OnBorder(cell) || before.values()[i] == segment.belief_after.values()[i]) continue;
    return Malformed("an edit at {}, on the border of the {} x {} map", cell, before.rows(),
                     before.columns());
  }
  return {};
}

Result<void> CheckInside(const BeliefGrid& map, std::span<const Cell> cells, const char* what) {
  for (const Cell cell : cells) {
    if (map.Contains(cell)) continue;
    return Malformed("{} cell {} is outside of the {} x {} map", what, cell, map.rows(),
                     map.columns());
  }
  return {};
}

Result<void> CheckPath(const PerceptionQuery& query) {
  if (query.path.empty()) return Malformed("the path is empty");
  if (query.path.back() == query.cell) return {};
  return Malformed("the path ends in {}, but the camera is in {}", query.path.back(), query.cell);
}

Result<void> CheckSorted(std::span<const Cell> cells, const char* what) {
  const auto wrong = std::ranges::adjacent_find(cells, [](Cell a, Cell b) { return !(a < b); });
  if (wrong == cells.end()) return {};
  return Malformed("seen {} cells are not sorted row-major without repeats: {} before {}", what,
                   wrong[0], wrong[1]);
}

Result<void> CheckSeenOnce(const VisibleCells& visible) {
  for (const Cell cell : visible.free) {
    if (!std::ranges::binary_search(visible.walls, cell)) continue;
    return Malformed("cell {} is seen both free and as a wall", cell);
  }
  return {};
}

Result<void> CheckQuery(const PerceptionQuery& query) {
  if (!(std::abs(query.heading_rad) <= kMaxHeading)) {
    return Malformed("the heading is {} rad; it must be in [-{}, {}]", query.heading_rad,
                     kMaxHeading, kMaxHeading);
  }
  const Cell camera[] = {query.cell};
  return CheckInside(query.belief, camera, "camera")
      .and_then([&] { return CheckInside(query.belief, query.path, "path"); })
      .and_then([&] { return CheckPath(query); })
      .and_then([&] { return CheckInside(query.belief, query.visible.free, "seen free"); })
      .and_then([&] { return CheckInside(query.belief, query.visible.walls, "seen wall"); })
      .and_then([&] { return CheckSorted(query.visible.free, "free"); })
      .and_then([&] { return CheckSorted(query.visible.walls, "wall"); })
      .and_then([&] { return CheckSeenOnce(query.visible); });
}

Result<void> CheckTimes(const Segment& segment) {
  double latest = 0.0;
  for (const auto& [name, time] :
       {std::pair("sent", segment.sent_s), std::pair("first edit", segment.first_edit_s),
        std::pair("confirmed", segment.confirmed_s)}) {
    if (!time) continue;
    if (!(std::isfinite(*time) && *time >= latest)) {
      return Malformed("time '{}' is {} s; it must be a number of at least {}", name, *time,
                       latest);
    }
    latest = *time;
  }
  return {};
}

Result<void> CheckTexts(const Trajectory& trajectory) {
  std::vector<std::pair<const char*, std::string_view>> texts{
      {"participant", trajectory.participant},
      {"session", trajectory.session},
      {"world", trajectory.world}};
  for (const auto& [name, value] : trajectory.annotator) texts.emplace_back("annotator", name);
  for (const auto& [what, text] : texts) {
    if (!IsUtf8(text)) return Malformed("the name of the {} is not UTF-8", what);
  }
  return {};
}

bool IsSha256(const std::string& text) {
  return text.size() == kSha256Digits &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

Result<void> CheckImage(const Segment& segment) {
  if (!IsUtf8(segment.image)) return Malformed("the image's file name is not UTF-8");
  const std::filesystem::path file(segment.image);
  const bool climbs = std::ranges::find(file, std::filesystem::path("..")) != file.end();
  if (file.is_absolute() || climbs) {
    return Malformed("image '{}' is not a file of the data set", segment.image);
  }
  if (segment.image_sha256.empty() || IsSha256(segment.image_sha256)) return {};
  return Malformed("image_sha256 '{}' is not {} lower-case hexadecimal digits",
                   segment.image_sha256, kSha256Digits);
}

Result<void> CheckShare(double share, const char* what) {
  if (share >= 0.0 && share <= 1.0) return {};
  return Malformed("{} is {}; it must be in [0, 1]", what, share);
}

Result<void> CheckAnnotator(const Trajectory& trajectory) {
  for (const auto& [name, value] : trajectory.annotator) {
    if (!std::isfinite(value)) return Malformed("annotator's {} is not a number", name);
  }
  return {};
}

tl::unexpected<Error> At(const std::string& place, const Error& error) {
  return Fail(error.code, place + ": " + error.text);
}

Result<void> CheckSegmentsOf(const Trajectory& trajectory, std::size_t number) {
  const Segment* before = nullptr;
  for (std::size_t i = 0; i < trajectory.segments.size(); ++i) {
    const Segment& segment = trajectory.segments[i];
    const auto checked = CheckSegment(segment).and_then(
        [&] { return CheckNextSegment(trajectory.truth, before, segment); });
    if (!checked) return At(SegmentPlace(number, i), checked.error());
    before = &segment;
  }
  return {};
}

}  // namespace

Result<void> CheckSegment(const Segment& segment) {
  return CheckMaps(segment)
      .and_then([&] { return CheckBorder(segment); })
      .and_then([&] { return CheckQuery(segment.query); })
      .and_then([&] { return CheckTimes(segment); })
      .and_then([&] { return CheckImage(segment); });
}

Result<void> CheckTrajectoryFacts(const Trajectory& trajectory) {
  return CheckShare(trajectory.initial_cell_accuracy, "initial cell accuracy")
      .and_then([&] { return CheckShare(trajectory.final_cell_accuracy, "final cell accuracy"); })
      .and_then(
          [&] { return CheckShare(trajectory.final_mapping_accuracy, "final mapping accuracy"); })
      .and_then([&] { return CheckAnnotator(trajectory); })
      .and_then([&] { return CheckTexts(trajectory); })
      .and_then([&] {
        return trajectory.truth ? CheckSides(*trajectory.truth, "the truth") : Result<void>();
      });
}

Result<void> CheckNextSegment(const std::optional<OccupancyGrid>& truth, const Segment* before,
                              const Segment& segment) {
  const BeliefGrid& map = segment.query.belief;
  if (truth) {
    const auto same = CheckSameShape(map, *truth, "x", "the truth");
    if (!same) return same;
  }
  if (before == nullptr) return {};
  if (segment.step <= before->step) {
    return Malformed("step {} after step {}; steps rise", segment.step, before->step);
  }
  return CheckSameShape(map, before->query.belief, "x", "the x of the segment before");
}

Result<void> CheckSegments(const SegmentSet& set) {
  for (std::size_t t = 0; t < set.trajectories.size(); ++t) {
    const Trajectory& trajectory = set.trajectories[t];
    const auto facts = CheckTrajectoryFacts(trajectory).and_then([&] {
      return trajectory.segments.empty() ? Malformed("it has no segments") : Result<void>();
    });
    if (!facts) return At(fmt::format("trajectory {}", t), facts.error());
    if (const auto checked = CheckSegmentsOf(trajectory, t); !checked) return checked;
  }
  return {};
}

std::string SegmentPlace(std::size_t trajectory, std::size_t segment) {
  return fmt::format("trajectory {}, segment {}", trajectory, segment);
}

}  // namespace conav
