#include "study/measures.h"

#include <algorithm>

#include "common/runtime/demand.h"

namespace conav::study {
namespace {

constexpr double kBytesPerMib = 1024.0 * 1024.0;

constexpr Measure kMeasures[] = {
    {"image_mib", "image MiB", "Communication, 180 KiB per picture (MiB)",
     [](const EpisodeMeasures& e) { return e.pictures * kPaperImageKib / 1024.0; }},
    {"sent_mib", "sent MiB", "Bytes of pictures really sent (MiB)",
     [](const EpisodeMeasures& e) { return e.picture_bytes / kBytesPerMib; }},
    {"low_level_steps", "steps", "Low-level steps (4 Hz)",
     [](const EpisodeMeasures& e) { return e.low_level_steps; }},
    {"cell_moves", "moves", "Moves from cell to cell",
     [](const EpisodeMeasures& e) { return e.cell_moves; }},
    {"pictures", "pictures", "Pictures sent", [](const EpisodeMeasures& e) { return e.pictures; }},
    {"guidance", "guidance", "Paths that the operator gave",
     [](const EpisodeMeasures& e) { return e.guidance; }},
    {"mapping_accuracy_after", "mapping", "Mapping accuracy at the end",
     [](const EpisodeMeasures& e) { return e.mapping_accuracy_after; }, true},
    {"goals_reached_fraction", "goals", "Share of the goals reached",
     [](const EpisodeMeasures& e) {
       return e.goals_total > 0.0 ? e.goals_reached / e.goals_total : 0.0;
     },
     true},
    {"time_s", "time s", "Simulated time (s)", [](const EpisodeMeasures& e) { return e.time_s; }},
};

}  // namespace

EpisodeMeasures MeasuresOf(const launcher::EpisodeMetrics& metrics) {
  EpisodeMeasures measures;
  for (const launcher::RobotMetrics& robot : metrics.robots) {
    measures.pictures += static_cast<double>(robot.pictures);
    measures.picture_bytes += static_cast<double>(robot.picture_bytes);
    measures.low_level_steps += static_cast<double>(robot.low_level_steps);
    measures.cell_moves += static_cast<double>(robot.cell_moves);
    measures.guidance += static_cast<double>(robot.guidance);
    measures.goals_reached += static_cast<double>(robot.goals_reached);
    measures.goals_total += static_cast<double>(robot.goals_total);
    measures.time_s = std::max(measures.time_s, robot.time_s);
  }
  measures.mapping_accuracy_after = metrics.after.mapping;
  measures.all_goals_reached = metrics.all_goals_reached;
  return measures;
}

std::span<const Measure> Measures() { return kMeasures; }

std::size_t MeasureIndex(const std::string& key) {
  const auto found = std::find_if(std::begin(kMeasures), std::end(kMeasures),
                                  [&](const Measure& measure) { return key == measure.key; });
  DEMAND(found != std::end(kMeasures), key);
  return static_cast<std::size_t>(found - std::begin(kMeasures));
}

}  // namespace conav::study
