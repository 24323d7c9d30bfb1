#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/cli/batch.h"
#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "common/segments/segment_split.h"
#include "nhpm/model/encoding.h"
#include "nhpm/model/weights_file.h"
#include "nhpm/training/example.h"
#include "nhpm/training/trainer.h"

namespace conav::nhpm {

/// The arguments of `conav train`; empty paths = off.
struct TrainArguments {
  std::filesystem::path data;
  std::filesystem::path out;
  std::filesystem::path json;  // "-" = standard output
  std::filesystem::path svg;
  TrainingOptions options;
  InputSelection inputs;
  std::uint64_t split_seed = kDefaultSplitSeed;
  int threads = 1;
  /// Ends the training after the epoch in which this time is over; 0 = no limit. The same command
  /// continues it.
  double limit_s = 0.0;
  bool any_size = false;   // declare that the weights fit maps of any size
  bool fresh = false;      // ignore a checkpoint of `out`
  bool overwrite = false;  // `out` may hold weights of another training
  bool quiet = false;      // one of a sweep: prints no summary
};

/// The arguments of `conav train --adapt`.
struct AdaptArguments {
  std::filesystem::path base;  // weights file
  std::filesystem::path data;
  std::filesystem::path out;
  std::filesystem::path json;  // "-" = standard output; empty = off
  bool overwrite = false;      // `out` may hold weights of another training
  std::string participant;     // may be empty if the data has only one
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Adapts the base to one participant and writes the weights. Exit code: 0 done, 1 failed or stopped.
int RunAdapt(const AdaptArguments& arguments, const StopToken& stop);

/// Does one training: the words of its command; returns its exit code.
using TrainOne = std::function<int(const std::vector<std::string>& words)>;

/// Trains once for each combination of the values of `sweep` ("seed=1..5", "width=16,32"), where
/// `batch` has no record of it, with the other words of this process's command. Prints a table of
/// the validation losses, copies the best weights to `arguments.out` and writes `arguments.json`.
/// Exit code: 0 done; 1 failed or stopped; 2 wrong use. Throws StartupError.
int RunSweep(const std::vector<std::string>& sweep, const TrainArguments& arguments,
             const conav::Batch& batch, const TrainOne& train);

/// Settings of `conav train --adapt` that the weights depend on, in NetworkModel::training.
inline constexpr const char* kAdaptSettings[] = {"base_checksum", "adapt_participant",
                                                 "adapt_data_sha256", "adapt_seed"};

/// Whether `conav train` may write to `out`: the file does not exist, or has the weights of a
/// training with the same settings. Errors: kRefused, naming the difference, or that it is no
/// weights file.
[[nodiscard]] Result<void> CheckReplaceable(const std::filesystem::path& out,
                                            const std::map<std::string, std::string>& settings);

/// An SVG document: training and validation loss, called `loss`, over the epochs, on a logarithmic
/// scale, with the best epoch marked. Requires at least one epoch and best_epoch among them.
std::string LossCurve(const TrainingState& state, const std::string& title,
                      const std::string& loss = "MBCE");

/// "MBCE", or with its class weight.
std::string LossName(const TrainingOptions& options);

/// Everything that the weights depend on, by name: a checkpoint must match it, and the weights file
/// records it.
std::map<std::string, std::string> SettingsOf(const TrainArguments& arguments,
                                              const TrainingData& data);

struct TrainingOutcome {
  NetworkModel model;  // the best weights, with settings and results
  double test_loss = 0.0;
  double seconds = 0.0;  // of this run
};

/// Measures the best weights on the test part. Where the loss weighs edits by a class weight, the
/// network learns odds that are this factor too high: the model's last biases are lowered by its
/// logarithm, so that its probabilities are those of the data.
TrainingOutcome OutcomeOf(const TrainArguments& arguments, const TrainingData& data,
                          const TrainingState& state, double seconds);

/// The summary printed at the end.
std::string SummaryText(const TrainArguments& arguments, const TrainingData& data,
                        const TrainingOutcome& outcome, const TrainingState& state);

/// For keys see docs/nhpm.md.
nlohmann::ordered_json ReportJson(const TrainArguments& arguments, const TrainingOutcome& outcome,
                                  const TrainingState& state);

}  // namespace conav::nhpm
