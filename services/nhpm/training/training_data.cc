#include "nhpm/training/training_data.h"

#include <fmt/format.h>

#include "common/runtime/file.h"
#include "common/runtime/sha256.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_labels.h"
#include "common/segments/segment_split.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kParts = 3;

Result<SegmentSet> CheckUsable(SegmentSet set) {
  const std::size_t trajectories = set.trajectories.size();
  if (SegmentCount(set) == 0) return Fail(ErrorCode::kInvalidArgument, "has no segments");
  if (trajectories < kParts) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("has {} {}; training needs three at least: to learn from, to know when "
                            "to stop, and to test on",
                            trajectories, trajectories == 1 ? "trajectory" : "trajectories"));
  }
  return set;
}

}  // namespace

Result<TrainingData> LoadTrainingData(const std::filesystem::path& file,
                                      const InputSelection& inputs, std::uint64_t split_seed) {
  const auto bytes = ReadFile(file);
  if (!bytes) return tl::unexpected(bytes.error());
  auto set = ReadSegmentFile(file);
  if (!set) return tl::unexpected(set.error());
  const auto load = [&](const SegmentSet& usable) -> Result<TrainingData> {
    if (const auto checked = CheckOneSize(usable); !checked) {
      return tl::unexpected(checked.error());
    }
    const SegmentSplit split = SplitSegments(usable, split_seed);
    return TrainingData{Sha256Hex(*bytes),
                        OriginText(usable),
                        usable.trajectories.size(),
                        ExamplesOf(split.train, inputs),
                        ExamplesOf(split.validation, inputs),
                        ExamplesOf(split.test, inputs)};
  };
  return CheckUsable(std::move(*set)).and_then(load).map_error([&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", file.string(), error.text)};
  });
}

std::string InputText(const InputSelection& inputs) {
  std::string text;
  const auto add = [&](bool seen, const char* name) {
    if (seen) text += fmt::format("{}{}", text.empty() ? "" : ",", name);
  };
  add(inputs.belief, "x");
  add(inputs.path, "tau");
  add(inputs.view, "o");
  return text.empty() ? "nothing" : text;
}

}  // namespace conav::nhpm
