#include <fmt/format.h>

#include "common/runtime/file.h"
#include "common/runtime/sha256.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_labels.h"
#include "common/segments/segment_split.h"
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

/// A warning where it is allowed, else a refusal that says what to do.
Result<std::string> Seen(const std::string& problem, const std::string& remedy, bool allowed) {
  if (allowed) return problem;
  return Fail(ErrorCode::kRefused, fmt::format("{}; {}, or --allow-seen", problem, remedy));
}

}  // namespace

Result<EvaluationData> LoadEvaluationData(const EvaluateArguments& arguments) {
  const auto bytes = ReadFile(arguments.data);
  if (!bytes) return tl::unexpected(bytes.error());
  auto set = ReadSegmentFile(arguments.data);
  if (!set) return tl::unexpected(set.error());
  EvaluationData data;
  data.file = arguments.data.filename().string();
  data.checksum = Sha256Hex(*bytes);
  if (arguments.all_test) {
    data.test = std::move(*set);
  } else {
    SegmentSplit split = SplitSegments(*set, arguments.split_seed);
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
  const std::string learned_from = Value(model, "data_sha256");
  const std::string split_seed = Value(model, "split_seed");
  if (Value(model, "adapt_data_sha256") == data.checksum) {
    return Seen(fmt::format("{}: was adapted to {} of {}, so it may have seen what it would be "
                            "tested on",
                            name.string(), Value(model, "adapt_participant"), data.file),
                "pass data that it was not adapted to", allow_seen);
  }
  if (learned_from.empty()) {
    return fmt::format("{}: does not say what it was trained on; it may have seen the test part",
                       name.string());
  }
  if (learned_from != data.checksum) {
    return fmt::format("{}: was trained on other data (SHA-256 {}...)", name.string(),
                       learned_from.substr(0, 8));
  }
  if (data.split_seed && split_seed == fmt::format("{}", *data.split_seed)) return std::string();
  return Seen(
      fmt::format("{}: was trained on {} with split seed {}, so it saw what it would be tested on",
                  name.string(), data.file, split_seed),
      fmt::format("pass --split-seed {}", split_seed), allow_seen);
}

}  // namespace conav::nhpm
