#include "nhpm/training/training_data.h"

#include <fmt/format.h>

#include "common/segments/segment_file.h"
#include "common/segments/segment_labels.h"
#include "common/segments/segment_split.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kParts = 3;

Result<void> CheckUsable(const SegmentSet& set) {
  const std::size_t trajectories = set.trajectories.size();
  if (SegmentCount(set) == 0) return Fail(ErrorCode::kInvalidArgument, "has no segments");
  if (trajectories < kParts) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("has {} {}; training needs three at least: to learn from, to know when "
                            "to stop, and to test on",
                            trajectories, trajectories == 1 ? "trajectory" : "trajectories"));
  }
  return CheckOneSize(set);
}

}  // namespace

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
