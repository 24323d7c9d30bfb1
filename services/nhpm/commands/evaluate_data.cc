#include <fmt/format.h>

#include "common/console/console.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_labels.h"
#include "common/segments/segment_split.h"
#include "common/segments/trajectory_fingerprint.h"
#include "nhpm/commands/evaluate_rows.h"

namespace conav::nhpm {
namespace {

void Append(const SegmentSet& from, SegmentSet& to) {
  to.trajectories.insert(to.trajectories.end(), from.trajectories.begin(), from.trajectories.end());
}

Result<void> CheckTestPart(const EvaluateArguments& arguments, const EvaluationData& data) {
  if (SegmentCount(data.test) > 0) return {};
  const std::size_t trajectories = data.train.trajectories.size();
  return Fail(
      ErrorCode::kInvalidArgument,
      fmt::format("{}: nothing is left to test on of {} {}; --all-test takes the whole file",
                  arguments.data.string(), trajectories,
                  trajectories == 1 ? "trajectory" : "trajectories"));
}

std::string Value(const NetworkModel& model, const char* name) {
  const auto found = model.training.find(name);
  return found == model.training.end() ? "" : found->second;
}

/// What to do about weights that saw the test part.
std::string Remedy(const NetworkModel& model, const EvaluationData& data) {
  const bool adapted = !Value(model, "adapt_data_sha256").empty();
  if (!adapted && Value(model, "data_sha256") == data.checksum) {
    return "pass --split-seed " + Value(model, "split_seed");
  }
  return "pass data that it never saw (for synthetic people, of another --seed)";
}

}  // namespace

Result<EvaluationData> LoadEvaluationData(const EvaluateArguments& arguments) {
  auto read = ReadIdentifiedSegments(arguments.data);
  if (!read) return tl::unexpected(read.error());
  EvaluationData data;
  data.file = arguments.data.filename().string();
  data.checksum = read->checksum;
  if (arguments.all_test) {
    data.test = std::move(read->set);
  } else {
    SegmentSplit split = SplitSegments(read->set, arguments.split_seed);
    data.train = std::move(split.train);
    Append(split.validation, data.train);
    data.test = std::move(split.test);
    data.split_seed = arguments.split_seed;
  }
  if (const auto checked = CheckTestPart(arguments, data); !checked) {
    return tl::unexpected(checked.error());
  }
  return data;
}

Result<std::string> CheckUnseen(const NetworkModel& model, const std::filesystem::path& name,
                                const EvaluationData& data, bool allow_seen) {
  if (model.learned_from.empty()) return UnknownLearning(name);
  const std::size_t seen = CountKnown(data.test, model.learned_from);
  if (seen == 0) return std::string();
  const std::string problem =
      fmt::format("{}: learned from {} of the {} trajectories that it would be tested on",
                  name.string(), seen, data.test.trajectories.size());
  if (allow_seen) return problem;
  return Fail(ErrorCode::kRefused,
              fmt::format("{}; {}, or --allow-seen", problem, Remedy(model, data)));
}

}  // namespace conav::nhpm
