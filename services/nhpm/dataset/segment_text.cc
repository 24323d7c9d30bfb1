#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/segments/segment_labels.h"
#include "nhpm/dataset/segment_picture.h"

namespace conav::nhpm {
namespace {

using CharacterGrid = Grid<char>;

CharacterGrid Drawn(const BeliefGrid& map) {
  CharacterGrid drawn(map.rows(), map.columns(), ' ');
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map.values()[i] != 0.0F) drawn.values()[i] = '#';
  }
  return drawn;
}

char CameraSign(double heading_rad) {
  constexpr std::string_view kSigns = ">^<v";
  const auto quarter = std::lround(heading_rad / (std::numbers::pi / 2.0)) % 4;
  return kSigns[static_cast<std::size_t>((quarter + 4) % 4)];
}

CharacterGrid Before(const PerceptionQuery& query) {
  CharacterGrid drawn = Drawn(query.belief);
  for (const Cell cell : query.path) drawn[cell] = 'o';
  drawn[query.cell] = CameraSign(query.heading_rad);
  return drawn;
}

CharacterGrid Shown(const PerceptionQuery& query) {
  CharacterGrid drawn(query.belief.rows(), query.belief.columns(), ' ');
  for (const Cell cell : query.visible.free) drawn[cell] = '.';
  for (const Cell cell : query.visible.walls) drawn[cell] = '#';
  return drawn;
}

CharacterGrid After(const Segment& segment) {
  CharacterGrid drawn = Drawn(segment.belief_after);
  const EditLabels labels = LabelsOf(segment);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (labels.add.values()[i] != 0) drawn.values()[i] = '+';
    if (labels.remove.values()[i] != 0) drawn.values()[i] = '-';
  }
  return drawn;
}

std::string RowOf(const CharacterGrid& grid, int row) {
  const auto columns = static_cast<std::size_t>(grid.columns());
  return {grid.values().data() + static_cast<std::size_t>(row) * columns, columns};
}

}  // namespace

std::string SegmentText(const ChosenSegment& chosen) {
  const Segment& segment = *chosen.segment;
  std::string text =
      fmt::format("segment {} (trajectory {}, step {}, {}): {} edits\n", chosen.index,
                  chosen.trajectory, segment.step, ToText(chosen.origin), EditCount(segment));
  const CharacterGrid panels[] = {Before(segment.query), Shown(segment.query), After(segment)};
  const auto width = static_cast<std::size_t>(std::max(panels[0].columns(), 6));
  text += fmt::format("  {:<{}}  {:<{}}  after\n", "before", width, "shown", width);
  for (int row = 0; row < panels[0].rows(); ++row) {
    text += fmt::format("  {:<{}}  {:<{}}  {}\n", RowOf(panels[0], row), width,
                        RowOf(panels[1], row), width, RowOf(panels[2], row));
  }
  return text;
}

}  // namespace conav::nhpm
