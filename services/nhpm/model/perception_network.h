#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "common/msg/perception_model.h"
#include "nhpm/engine/kernels.h"
#include "nhpm/engine/packed_weights.h"
#include "nhpm/model/weights_file.h"

namespace conav::nhpm {

/// NHPM: the trained network as a model. Consecutive queries about one belief, as a planner asks
/// them, cost a fraction: it recomputes only what a changed path, view or cell of the belief can reach
/// (InferencePass), with the same bits.
///
/// Errors:  as PerceptionModel; kUnavailable names both sizes when the weights are bound to a grid
///          size and a query has another; kOutOfRange when weights, finite as they are, overflow.
/// Threads: safe to call concurrently; each call works on memory of its own, about 1 KB per cell, of
///          which the newest and up to kIdleBytes in all are kept for the next ones. Without it a
///          call begins with a whole pass.
class PerceptionNetwork final : public PerceptionModel {
 public:
  static constexpr std::size_t kIdleBytes = 256 << 20;

  explicit PerceptionNetwork(const NetworkModel& model);
  /// With another than the best instruction set, for tests and benchmarks.
  PerceptionNetwork(const NetworkModel& model, InstructionSet set);
  ~PerceptionNetwork() override;

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  /// Costs what the views and the belief's changes can reach, not what the map holds, but for the first
  /// call and one comparison of each new belief with the one before.
  [[nodiscard]] Result<std::vector<double>> PredictEdits(const SharedBelief& belief,
                                                         std::span<const ShownView> views) override;
  ModelIdentity identity() const override { return identity_; }

  /// What is kept for the next calls.
  std::size_t idle_bytes() const;
  /// Passes over all cells so far; the others were over what had changed.
  std::uint64_t whole_passes() const { return whole_passes_; }

 private:
  class Workspace;
  class Lease;

  Result<void> CheckSize(const BeliefGrid& belief) const;
  Error NotFinite() const;
  std::size_t IdleBytesLocked() const;

  ModelIdentity identity_;
  InputSelection inputs_;
  int rows_;
  int columns_;
  const KernelSet& kernels_;
  std::shared_ptr<const PackedWeights> weights_;
  std::atomic<std::uint64_t> whole_passes_{0};
  mutable std::mutex mutex_;  // guards idle_
  std::vector<std::unique_ptr<Workspace>> idle_;
};

}  // namespace conav::nhpm
