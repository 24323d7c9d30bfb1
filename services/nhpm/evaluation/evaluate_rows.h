#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "nhpm/evaluation/evaluate_main.h"
#include "nhpm/evaluation/evaluation.h"
#include "nhpm/model/weights_file.h"

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
