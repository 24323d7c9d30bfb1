#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/msg/planning.h"
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

/// What table 1 of the paper measures, and more. All figures are 0 for no segments, unless said
/// otherwise.
namespace conav::nhpm {

/// Probabilities are kept this far from 0 and 1 where a logarithm is taken, so that a model that was
/// sure and wrong has a large but finite loss: -ln(1e-7) = 16.1 nats.
inline constexpr double kProbabilityFloor = 1.0e-7;
inline constexpr double kFixedBoundary = 0.5;
inline constexpr double kBoundaryStep = 0.01;

/// Binary cross-entropy in nats: -ln p where the cell was edited, else -ln(1 - p).
double CrossEntropy(double probability, bool edited);

struct Loss {
  double all = 0.0;       // MBCE over all 2 rows columns outputs: masked ones cost 0 but count
  double unmasked = 0.0;  // mean over the outputs that are not masked
};
/// Paper section 6.1, MBCE.
Loss MeanCrossEntropy(const Outcomes& outcomes);

/// The predicted edits are the outputs with p >= boundary. |predicted and true| / |predicted or
/// true| over all segments (micro average); 1 where nothing is in the union. Paper section 6.1.
double IouAt(const Outcomes& outcomes, double boundary);

struct BoundaryIou {
  double boundary = 0.0;
  double iou = 0.0;
};
/// The best of the boundaries 0.01, 0.02, ..., 0.99; the lowest of several. 0 for no segments.
BoundaryIou BestIou(const Outcomes& outcomes);

/// Mean IoU of those segments whose union is not empty; nothing where there is none.
std::optional<double> SegmentMeanIou(const Outcomes& outcomes, double boundary);

/// One bar of a reliability diagram.
struct ReliabilityBin {
  double low = 0.0;
  double high = 0.0;  // not included, but for the last
  std::size_t outputs = 0;
  double mean_probability = 0.0;
  double edited_share = 0.0;
};
struct Calibration {
  /// Mean over the unmasked outputs of |mean probability - share edited| of their bin.
  double error = 0.0;
  std::vector<ReliabilityBin> bins;  // equal widths, empty ones too
};
/// Expected calibration error: Naeini, Cooper, Hauskrecht, "Obtaining well calibrated probabilities
/// using Bayesian binning", AAAI 2015, on the probability of an edit.
Calibration Calibrate(const Outcomes& outcomes, int bins = 10);

/// Segments of about the same number of expected edits.
struct EditBin {
  std::size_t segments = 0;
  double mean_expected = 0.0;
  double mean_true = 0.0;
};
/// Number of edits to one picture: the sum of the probabilities against what was done.
struct EditCounts {
  double mean_expected = 0.0;
  double mean_true = 0.0;
  std::optional<double> correlation;  // Pearson's; nothing where one of both never changes
  std::vector<EditBin> bins;          // of equal numbers of segments, fewest edits expected first
};
EditCounts CompareEditCounts(const Outcomes& outcomes, std::size_t bins = 10);

}  // namespace conav::nhpm
