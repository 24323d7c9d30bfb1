#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/msg/planning.h"
#include "common/runtime/result.h"
#include "common/segments/segment.h"

/// The figures of the paper's table 1, and more. All are 0 for no segments, unless stated otherwise.
namespace conav::nhpm {

/// One unmasked output: the model's probability and the person's edit.
struct Outcome {
  float probability = 0.0F;
  bool edited = false;
  bool operator==(const Outcome&) const = default;
};

/// The unmasked outputs of a model on some segments. Each cell inside the border has one: "add"
/// where x has no wall, "remove" where it has one. Masked outputs are left out: the model's value
/// counts as 0 there, and a person cannot edit there.
struct Outcomes {
  std::vector<Outcome> values;            // segment after segment, row-major
  std::vector<std::size_t> segment_ends;  // index into `values` behind each segment's last
  std::size_t outputs = 0;  // including masked ones: 2 * rows * columns of each segment

  std::size_t segments() const { return segment_ends.size(); }
  std::span<const Outcome> Segment(std::size_t index) const;
};

/// Pairs each segment with the answer to its query. The segments passed CheckSegment.
/// Errors: kInvalidArgument, with the number of the segment: another number of answers, a grid of
///         another size, a probability that is not in [0, 1].
[[nodiscard]] Result<Outcomes> PairOutcomes(std::span<const Segment* const> segments,
                                            std::span<const PerceptionAnswer> answers);

/// Logarithms use probabilities at least this far from 0 and 1, so that a confident, wrong model
/// has a large but finite loss: -ln(1e-7) = 16.1 nats.
inline constexpr double kProbabilityFloor = 1.0e-7;
inline constexpr double kFixedBoundary = 0.5;
inline constexpr double kBoundaryStep = 0.01;

/// Binary cross-entropy in nats: -ln p where the cell was edited, else -ln(1 - p).
double CrossEntropy(double probability, bool edited);

struct Loss {
  double all = 0.0;       // MBCE over all 2 rows columns outputs: masked ones cost 0 but count
  double unmasked = 0.0;  // mean over the unmasked outputs
};
/// Paper section 6.1, MBCE.
Loss MeanCrossEntropy(const Outcomes& outcomes);

/// The predicted edits are the outputs with p >= boundary. |predicted and true| / |predicted or
/// true| over all segments (micro average); 1 for an empty union. Paper section 6.1.
double IouAt(const Outcomes& outcomes, double boundary);

struct BoundaryIou {
  double boundary = 0.0;
  double iou = 0.0;
};
/// The best of the boundaries 0.01, 0.02, ..., 0.99; on ties the lowest. 0 for no segments.
BoundaryIou BestIou(const Outcomes& outcomes);

/// Mean IoU of the segments whose union is not empty; empty without such a segment.
std::optional<double> SegmentMeanIou(const Outcomes& outcomes, double boundary);

/// One bar of a reliability diagram.
struct ReliabilityBin {
  double low = 0.0;
  double high = 0.0;  // exclusive, except in the last bin
  std::size_t outputs = 0;
  double mean_probability = 0.0;
  double edited_share = 0.0;
};
struct Calibration {
  /// Mean over the unmasked outputs of |mean probability - edited share| of their bin.
  double error = 0.0;
  std::vector<ReliabilityBin> bins;  // equal widths, including empty ones
};
/// Expected calibration error: Naeini, Cooper, Hauskrecht, "Obtaining well calibrated probabilities
/// using Bayesian binning", AAAI 2015, on the probability of an edit.
Calibration Calibrate(const Outcomes& outcomes, int bins = 10);

/// Segments with similar expected edits.
struct EditBin {
  std::size_t segments = 0;
  double mean_expected = 0.0;
  double mean_true = 0.0;
};
/// Number of edits per picture: the sum of the probabilities against the actual edits.
struct EditCounts {
  double mean_expected = 0.0;
  double mean_true = 0.0;
  std::optional<double> correlation;  // Pearson's; empty if either is constant
  std::vector<EditBin> bins;          // of equal numbers of segments, fewest expected edits first
};
EditCounts CompareEditCounts(const Outcomes& outcomes, std::size_t bins = 10);

}  // namespace conav::nhpm
