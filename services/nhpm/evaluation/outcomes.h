#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/protocol/planning.h"
#include "common/runtime/result.h"
#include "common/segments/segment.h"

namespace conav::nhpm {

/// One output that is not masked: what the model promised and what the person did.
struct Outcome {
  float probability = 0.0F;
  bool edited = false;
  bool operator==(const Outcome&) const = default;
};

/// The outputs of a model that are not masked, on some segments. Each cell inside of the border has
/// one: "add" where x has no wall, "remove" where it has one. Masked outputs are not kept: whatever
/// a model says there counts as 0, and nobody can edit there.
struct Outcomes {
  std::vector<Outcome> values;            // segment after segment, row-major
  std::vector<std::size_t> segment_ends;  // index into `values` behind each segment's last
  std::size_t outputs = 0;                // masked ones too: 2 * rows * columns of each segment

  std::size_t segments() const { return segment_ends.size(); }
  std::span<const Outcome> Segment(std::size_t index) const;
};

/// Pairs each segment with the answer to its query. The segments passed CheckSegment.
/// Errors: kInvalidArgument, with the number of the segment: another number of answers, a grid of
/// another size, a probability that is not in [0, 1].
[[nodiscard]] Result<Outcomes> PairOutcomes(std::span<const Segment* const> segments,
                                            std::span<const PerceptionAnswer> answers);

}  // namespace conav::nhpm
