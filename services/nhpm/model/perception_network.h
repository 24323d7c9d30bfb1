#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "nhpm/engine/kernels.h"
#include "nhpm/engine/packed_weights.h"
#include "nhpm/model/edit_model.h"
#include "nhpm/model/weights_file.h"

namespace conav::nhpm {

/// NHPM: the trained network as a model. Queries about one belief that follow each other, as a
/// planner asks them, cost a fraction: only what a changed path or view can reach is computed
/// (InferencePass), with the same bits.
///
/// Errors:  as EditModel; kInvalidArgument names both sizes when the weights are bound to a grid
///          size and a query has another.
/// Threads: safe to call concurrently; each call works on memory of its own, which is kept for the
///          next one.
class PerceptionNetwork final : public EditModel {
 public:
  explicit PerceptionNetwork(const NetworkModel& model);
  /// With another than the best instruction set, for tests and benchmarks.
  PerceptionNetwork(const NetworkModel& model, InstructionSet set);
  ~PerceptionNetwork() override;

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) const override;
  const ModelIdentity& identity() const override { return identity_; }

 private:
  class Workspace;
  class Lease;

  Result<void> Check(const PerceptionQuery& query) const;

  ModelIdentity identity_;
  InputSelection inputs_;
  int rows_;
  int columns_;
  const KernelSet& kernels_;
  std::shared_ptr<const PackedWeights> weights_;
  mutable std::mutex mutex_;  // guards idle_
  mutable std::vector<std::unique_ptr<Workspace>> idle_;
};

}  // namespace conav::nhpm
