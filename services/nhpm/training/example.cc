#include "nhpm/training/example.h"

#include <fmt/core.h>

#include "common/segments/segment_file.h"

namespace conav::nhpm {
namespace {

OutputLabel Label(bool possible, bool edited) {
  if (!possible) return OutputLabel::kMasked;
  return edited ? OutputLabel::kEdited : OutputLabel::kKept;
}

std::vector<OutputLabel> LabelsOfOutputs(const Segment& segment) {
  const BeliefGrid& belief = segment.query.belief;
  const EditLabels edits = LabelsOf(segment);
  std::vector<OutputLabel> labels;
  labels.reserve(belief.size() * kOutputChannels);
  for (std::size_t i = 0; i < belief.size(); ++i) {
    const bool inside = !belief.OnBorder(belief.CellAt(i));
    const bool wall = belief.values()[i] != 0.0F;
    labels.push_back(Label(inside && !wall, edits.add.values()[i] != 0));
    labels.push_back(Label(inside && wall, edits.remove.values()[i] != 0));
  }
  return labels;
}

Example ExampleOf(const Segment& segment, const InputSelection& inputs) {
  Example example;
  example.input.resize(segment.query.belief.size() * kInputChannels);
  EncodeInput(segment.query, inputs, example.input);
  example.labels = LabelsOfOutputs(segment);
  example.camera = segment.query.cell;
  example.heading_rad = segment.query.heading_rad;
  return example;
}

constexpr std::size_t kParts = 3;

Result<void> CheckUsable(const SegmentSet& set) {
  const std::size_t trajectories = set.trajectories.size();
  if (SegmentCount(set) == 0) return Fail(ErrorCode::kInvalidArgument, "has no segments");
  if (trajectories < kParts) {
    return Fail(
        ErrorCode::kInvalidArgument,
        fmt::format(
            "has {} {}; training needs at least three: one each for training, validation and test",
            trajectories, trajectories == 1 ? "trajectory" : "trajectories"));
  }
  return CheckOneSize(set);
}

}  // namespace

Result<void> CheckOneSize(const SegmentSet& segments) {
  const BeliefGrid* first = nullptr;
  for (const Segment* segment : AllSegments(segments)) {
    const BeliefGrid& belief = segment->query.belief;
    if (first == nullptr) first = &belief;
    if (belief.rows() == first->rows() && belief.columns() == first->columns()) continue;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("has maps of {} x {} and of {} x {} cells; one network is trained on "
                            "one size",
                            first->rows(), first->columns(), belief.rows(), belief.columns()));
  }
  return {};
}

ExampleSet ExamplesOf(const SegmentSet& segments, const InputSelection& inputs) {
  ExampleSet result;
  for (const Segment* segment : AllSegments(segments)) {
    const BeliefGrid& belief = segment->query.belief;
    if (result.examples.empty()) {
      result.rows = belief.rows();
      result.columns = belief.columns();
    }
    DEMAND(belief.rows() == result.rows && belief.columns() == result.columns, belief.rows(),
           belief.columns(), result.rows, result.columns);
    result.examples.push_back(ExampleOf(*segment, inputs));
  }
  return result;
}

double EditShare(const ExampleSet& set) {
  double kept = 1.0;
  double edited = 1.0;
  for (const Example& example : set.examples) {
    for (const OutputLabel label : example.labels) {
      kept += label == OutputLabel::kKept ? 1.0 : 0.0;
      edited += label == OutputLabel::kEdited ? 1.0 : 0.0;
    }
  }
  return edited / (kept + edited);
}

Result<TrainingData> LoadTrainingData(const std::filesystem::path& file,
                                      const InputSelection& inputs, std::uint64_t split_seed) {
  const auto read = ReadIdentifiedSegments(file);
  if (!read) return tl::unexpected(read.error());
  if (const auto checked = CheckUsable(read->set); !checked) {
    return Fail(checked.error().code, fmt::format("{}: {}", file.string(), checked.error().text));
  }
  const SegmentSplit split = SplitSegments(read->set, split_seed);
  return TrainingData{read->checksum,
                      OriginText(read->set),
                      read->set.trajectories.size(),
                      Union(FingerprintsOf(split.train), FingerprintsOf(split.validation)),
                      ExamplesOf(split.train, inputs),
                      ExamplesOf(split.validation, inputs),
                      ExamplesOf(split.test, inputs)};
}

}  // namespace conav::nhpm
