#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "common/runtime/result.h"
#include "nhpm/model/weights_file.h"
#include "nhpm/training/example.h"
#include "nhpm/training/train_command.h"
#include "nhpm/training/trainer.h"

namespace conav::nhpm {

/// Settings of `conav train --adapt` that the weights depend on, in NetworkModel::training.
inline constexpr const char* kAdaptSettings[] = {"base_checksum", "adapt_participant",
                                                 "adapt_data_sha256", "adapt_seed"};

/// Whether `conav train` may write to `out`: the file does not exist, or has the weights of a
/// training with the same settings. Errors: kRefused, naming the difference, or that it is no
/// weights file.
[[nodiscard]] Result<void> CheckReplaceable(const std::filesystem::path& out,
                                            const std::map<std::string, std::string>& settings);

/// An SVG document: training and validation loss over the epochs, on a logarithmic scale, with the
/// best epoch marked. Requires at least one epoch and best_epoch among them.
std::string LossCurve(const TrainingState& state, const std::string& title);

/// Everything that the weights depend on, by name: a checkpoint must match it, and the weights file
/// records it.
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

/// The summary printed at the end.
std::string SummaryText(const TrainArguments& arguments, const TrainingData& data,
                        const TrainingOutcome& outcome, const TrainingState& state);

/// For keys see docs/nhpm.md.
nlohmann::ordered_json ReportJson(const TrainArguments& arguments, const TrainingOutcome& outcome,
                                  const TrainingState& state);

}  // namespace conav::nhpm
