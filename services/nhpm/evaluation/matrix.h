#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/runtime/result.h"
#include "common/runtime/threads.h"
#include "nhpm/model/encoding.h"
#include "nhpm/training/trainer.h"

// One user: its command; the comparison on strangers is looked for by name.

/// Models of how people edit, tested on people of other kinds than those they learned from.
namespace conav::nhpm {

/// Of MatrixArguments::train_on: all kinds of `test_on` but the one tested on.
inline constexpr const char* kOthers = "others";

inline constexpr const char* kProgram = "conav evaluate";

/// The arguments of `conav evaluate --train-on ... --test-on ...`.
struct MatrixArguments {
  /// Kinds of people: a population (YAML, as for `conav dataset synthesize`) or anybody's segments.
  /// Of the first also "others": all kinds of `test_on` but the one tested on.
  std::vector<std::string> train_on;
  std::vector<std::string> test_on;
  int trajectories = 150;      // of each population, to learn from
  int test_trajectories = 60;  // of each population, each of another person
  std::vector<int> curve;      // learns from these numbers of trajectories of the kind tested on
  int people = 0;              // of each kind, for the adaptation to one person
  std::string view_encoding = "depth";
  TrainingOptions training{.epochs = 30,
                           .batch = 32,
                           .learning_rate = 0.003,
                           .schedule = LearningRateSchedule::kLinear,
                           .patience = 0};
  std::uint64_t seed = 1;  // the test uses the next one, the adaptation the one after
  std::filesystem::path cache = "data/matrix";
  // Those of the table on one file:
  int oracle_draws = 20000;
  int threads = 1;
  bool check = false;
  std::filesystem::path json;
  std::filesystem::path html;

  bool wanted() const { return !train_on.empty() || !test_on.empty(); }
};

void AddMatrixFlags(CLI::App& app, MatrixArguments& arguments);

/// For each kind to learn from (A) and to test on (B): NHPM and GLPF-Train of A, GLPF-Test and oracle
/// of B. Each training and each figure is kept in `cache` under a digest of all that it depends on,
/// so the same command continues after an interruption, and a larger one reuses what is there.
///
/// JSON: schema, data_origin, settings;
///   matrix.A.B           nhpm_mbce, nhpm_iou, nhpm_ece, nhpm_reliability, glpf_mbce, glpf_iou,
///                        pool_mbce, pool_iou (both pooled, half and half),
///                        glpf_test_mbce, glpf_test_iou, oracle_mbce, oracle_iou (null for people)
///   curve.B.N            the same figures, learned from N trajectories of B
///   adaptation.B         0, 5, 20, 100: MBCE on other mazes of the same person after so many of
///                        their segments, mean over people, from weights that learned from the others;
///                        people; the GLPF of the others (glpf), fitted further to
///                        the same segments (glpf_5, glpf_20, glpf_100); both pooled, whose
///                        weights alone learn (pool_0, pool_5, pool_20, pool_100)
///   bars                 value, limit, kinds, passed; for the adaptation of kinds with such people
/// Exit code: 0 done; 1 failed or stopped, or with `check` a bar was missed; 2 wrong use.
int RunMatrix(const MatrixArguments& arguments, const StopToken& stop);

/// The JSON. Errors: those of reading, synthesis and training, with the kind; kUnavailable: stopped.
[[nodiscard]] Result<nlohmann::ordered_json> ComputeMatrix(const MatrixArguments& arguments,
                                                           const StopToken& stop);

}  // namespace conav::nhpm
