#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/segments/segment_split.h"
#include "nhpm/evaluation/evaluation.h"
#include "nhpm/model/weights_file.h"

// One user: main; the rows of table 1 are looked for by name.

namespace conav::nhpm {

/// The arguments of `conav evaluate`; empty paths = off.
struct EvaluateArguments {
  std::filesystem::path data;
  std::vector<std::filesystem::path> weights;  // none = the shipped ones, if any
  std::vector<std::string> without;            // "tau", "o", "x": one more row for each
  std::uint64_t split_seed = kDefaultSplitSeed;
  bool all_test = false;  // no split: the weights never saw this file
  bool allow_seen = false;
  int oracle_draws = 20000;  // a segment; 0 = no oracle
  bool average_oracle = false;
  int threads = 1;
  std::vector<std::size_t> segments;  // for the page; none = chosen by content
  std::filesystem::path json;         // "-" = standard output, for the next two as well
  std::filesystem::path csv;
  std::filesystem::path html;
  bool check = false;  // a missed bar is a failure; no bar at all is wrong usage
};

/// Prints table 1 on standard output and writes the files; progress on standard error. Exit code: 0
/// done, 1 failed, 2 wrong usage.
int RunEvaluate(const EvaluateArguments& arguments);

}  // namespace conav::nhpm

/// The rows of table 1.
namespace conav::nhpm {

/// Receives progress and warnings: "NHPM: 64 of 85 segments".
using Reporter = std::function<void(const std::string& text)>;

/// Reads the segments and splits them as `conav train` does.
/// Errors: those of ReadSegmentFile; kInvalidArgument if no segments are left for the test.
[[nodiscard]] Result<EvaluationData> LoadEvaluationData(const EvaluateArguments& arguments);

/// Checks that `model` never learned from a trajectory of the test part, in any file. Returns a
/// warning if that is unknown or allowed, else an empty text.
/// Errors: kRefused if it did; `name` is the weights file.
[[nodiscard]] Result<std::string> CheckUnseen(const NetworkModel& model,
                                              const std::filesystem::path& name,
                                              const EvaluationData& data, bool allow_seen);

/// One row per weights file and one more for each input left out: keys nhpm, nhpm_2, ...,
/// nhpm_without_tau, ... Reports warnings. Errors name the file.
[[nodiscard]] Result<std::vector<ModelRow>> NetworkRows(const EvaluateArguments& arguments,
                                                        const EvaluationData& data,
                                                        const Reporter& warn,
                                                        const Reporter& progress);

/// Whether the editors of the test part are known: synthetic annotators, all of them.
bool HasOracle(const EvaluationData& data);

/// The synthetic annotators themselves (key oracle), and the best possible model that does not know
/// who looked (key oracle_average): the mean over people of the train part. Empty for data of
/// people or of a simulated operator.
/// Errors: those of OracleAnswers, with the file; kInvalidArgument when the train part has no
///         synthetic people.
[[nodiscard]] Result<std::vector<ModelRow>> OracleRows(const EvaluateArguments& arguments,
                                                       const EvaluationData& data,
                                                       const Reporter& progress);

}  // namespace conav::nhpm
