#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

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

/// What is printed at the end.
std::string SummaryText(const TrainArguments& arguments, const TrainingData& data,
                        const TrainingOutcome& outcome, const TrainingState& state);

/// Keys in docs/nhpm.md.
nlohmann::ordered_json ReportJson(const TrainArguments& arguments, const TrainingOutcome& outcome,
                                  const TrainingState& state);

}  // namespace conav::nhpm
