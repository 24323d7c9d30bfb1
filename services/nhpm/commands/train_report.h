#pragma once

#include <map>
#include <string>

#include "common/runtime/result.h"
#include "nhpm/commands/train_command.h"
#include "nhpm/model/weights_file.h"
#include "nhpm/training/training_data.h"

namespace conav::nhpm {

/// All that the weights depend on, by name: what a checkpoint must agree with and what a weights
/// file says about its training.
std::map<std::string, std::string> SettingsOf(const TrainArguments& arguments,
                                              const TrainingData& data);

struct TrainingOutcome {
  NetworkModel model;  // the best weights, with settings and results
  double test_loss = 0.0;
  double seconds = 0.0;  // of this run
};

/// Measures the best weights on the test part.
TrainingOutcome OutcomeOf(const TrainArguments& arguments, const TrainingData& data,
                          const TrainingState& state, double seconds);

std::string CurveTitle(const TrainingOutcome& outcome);

/// To standard output.
void PrintSummary(const TrainArguments& arguments, const TrainingData& data,
                  const TrainingOutcome& outcome, const TrainingState& state);

/// JSON, keys in docs/nhpm.md; "-" is standard output, empty nowhere. Errors: kIo.
[[nodiscard]] Result<void> WriteTrainReport(const std::filesystem::path& path,
                                            const TrainArguments& arguments,
                                            const TrainingOutcome& outcome,
                                            const TrainingState& state);

}  // namespace conav::nhpm
