#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "nhpm/evaluation/evaluate_main.h"
#include "nhpm/evaluation/evaluation.h"
#include "nhpm/model/weights_file.h"

/// Where the rows of table 1 come from.
namespace conav::nhpm {

/// Tells what goes on, "NHPM: 64 of 85 segments".
using Reporter = std::function<void(const std::string& text)>;

/// Reads the segments and splits them as `conav train` does.
/// Errors: those of ReadSegmentFile; kInvalidArgument when nothing is left to test on.
[[nodiscard]] Result<EvaluationData> LoadEvaluationData(const EvaluateArguments& arguments);

/// Whether `model` learned from a trajectory of the test part, in whatever file that was. Nothing to
/// say: empty. Unknown, or allowed: a warning.
/// Errors: kRefused when it did; `name` is the weights file.
[[nodiscard]] Result<std::string> CheckUnseen(const NetworkModel& model,
                                              const std::filesystem::path& name,
                                              const EvaluationData& data, bool allow_seen);

/// A row per weights file and one more for each input left out: keys nhpm, nhpm_2, ...,
/// nhpm_without_tau, ... Warnings are told. Errors name the file.
[[nodiscard]] Result<std::vector<ModelRow>> NetworkRows(const EvaluateArguments& arguments,
                                                        const EvaluationData& data,
                                                        const Reporter& warn,
                                                        const Reporter& progress);

/// Whether those who edited the test part are known: synthetic annotators, all of them.
bool HasOracle(const EvaluationData& data);

/// The synthetic annotators themselves (key oracle), and what a model could do at best that does not
/// know who looked (key oracle_average): the mean over people of the train part. Empty for data of
/// people or of a simulated operator.
/// Errors: those of OracleAnswers, with the file; kInvalidArgument when the train part has nobody to
/// take the mean of.
[[nodiscard]] Result<std::vector<ModelRow>> OracleRows(const EvaluateArguments& arguments,
                                                       const EvaluationData& data,
                                                       const Reporter& progress);

}  // namespace conav::nhpm
