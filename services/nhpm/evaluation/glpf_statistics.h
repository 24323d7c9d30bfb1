#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "common/segments/segment.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

/// Cells to which a GLPF gives one and the same probability, whatever its parameters.
struct StimulusCount {
  double outputs = 0.0;
  double edits = 0.0;
};

/// All that a GLPF's loss on a set of segments depends on: how many cells have which stimulus, and
/// how many of them were edited. So a fit costs the same for any number of segments.
struct GlpfStatistics {
  /// By squared distance to the camera in cells: wrong on the map, as the picture shows.
  std::map<int, StimulusCount> seen;
  /// Walls of the map on the path that the picture does not show: a stimulus unless visible_only.
  std::map<int, StimulusCount> on_path;
  StimulusCount unstimulated;

  double outputs() const;
};

/// Over the outputs that are not masked. The segments passed CheckSegment.
GlpfStatistics CountStimuli(std::span<const Segment* const> segments);

/// Mean cross-entropy of the GLPF over the outputs that are not masked, in nats; 0 for none. As
/// MeanCrossEntropy(...).unmasked of its answers, but for their rounding to float.
double GlpfLoss(const GlpfStatistics& statistics, const GlpfParameters& parameters);

}  // namespace conav::nhpm
