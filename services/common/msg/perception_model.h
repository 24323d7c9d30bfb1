#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/msg/planning.h"
#include "common/runtime/result.h"

namespace conav {

/// Which model answers. Equal checksums give equal bits for equal queries.
struct ModelIdentity {
  std::string name;      // "nhpm", "glpf", or what the weights file says
  std::string version;   // for people
  std::string checksum;  // SHA-256 of the parameters, 64 hexadecimal digits; empty = unknown
  bool operator==(const ModelIdentity&) const = default;
};

/// A belief that no longer changes.
using SharedBelief = std::shared_ptr<const BeliefGrid>;

/// Predicts how the operator edits the map: the seam between what asks (the planner, the nhpm
/// service, the evaluator) and what answers: GLPF, network, remote over DDS, cached, fake.
///
/// Shapes:  one answer per query, in order; grids as large as the query's belief; masked as
///          PerceptionAnswer says.
/// Errors:  kInvalidArgument (CheckPerceptionQuery: no model can answer the query), kUnavailable
///          (also good queries of a grid size that the model was not made for), kTimeout,
///          kOutOfRange (the model's arithmetic overflows). Never throws. An empty batch gives an
///          empty answer.
/// Threads: safe to call concurrently. Blocks until the whole batch is answered or the model gives
///          up.
/// Source:  paper section 4, F_theta(x, tau, o); every model behind it gives equal bits for equal
///          queries.
class PerceptionModel {
 public:
  virtual ~PerceptionModel() = default;

  [[nodiscard]] virtual Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) = 0;

  /// ExpectedEdits() of the answers to `views` of one belief, with the same bits: all that a search
  /// needs of an answer, and cheaper where the model knows what `views` can change. Equal pointers
  /// tell the model that the belief is the one of an earlier call.
  [[nodiscard]] virtual Result<std::vector<double>> PredictEdits(const SharedBelief& belief,
                                                                 std::span<const ShownView> views);

  /// The operator's map after they saw the picture of `query`: for models that learn who this is.
  virtual void ReceivedEdits(const PerceptionQuery& /*query*/, const BeliefGrid& /*after*/) {}

  /// Changes when another model answers from now on: remembered answers are no longer its answers.
  /// If it is the same before and after Predict(), it is the one that answered.
  virtual ModelIdentity identity() const = 0;
};

/// A perception model for tests, next to its interface. The operator corrects a cell that a picture
/// shows and that the belief has wrong with probability near_probability * exp(-decay * distance in
/// cells), and a wall on the robot's path with path_probability. Deterministic; needs no truth, as
/// it looks at belief, path and view only.
class FakePerceptionModel final : public PerceptionModel {
 public:
  struct Options {
    double near_probability = 0.6;
    double decay = 0.15;
    double path_probability = 0.9;
  };

  FakePerceptionModel() = default;
  explicit FakePerceptionModel(const Options& options) : options_(options) {}

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  ModelIdentity identity() const override { return {"fake", "", ""}; }

 private:
  PerceptionAnswer Answer(const PerceptionQuery& query) const;

  Options options_;
};

}  // namespace conav
