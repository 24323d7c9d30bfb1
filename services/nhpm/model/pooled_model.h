#pragma once

#include <memory>
#include <mutex>

#include "common/msg/perception_model.h"
#include "nhpm/model/glpf.h"

namespace conav::nhpm {

/// The GLPF fitted to the people that the shipped network learned from (docs/training.md).
inline constexpr GlpfParameters kGlpfOfTenKinds{
    .alpha_d = 0.01436, .alpha_m = 0.9029, .beta = 7.03, .rho = 0.0, .lambda = 0.0};

/// Averages the log odds that two models give each edit: for strangers, whom no model has learned from.
///
/// A logarithmic opinion pool. The second model has the weight 1 / (1 + exp(-lead)), rounded to
/// hundredths: lead is by how many nats it has predicted this person's edits better so far, over all
/// unmasked outputs. At first both have half; then the better one takes over. Pictures fade from the
/// comparison, each to kMemory with the next one.
///
/// When another model answers for the first one (a fallback, new weights) the comparison begins again.
/// Errors: those of the models. A picture that one of them cannot answer says nothing of either.
/// Threads: as PerceptionModel.
/// Source: C. Genest and J. Zidek, "Combining probability distributions", 1986 (the pool); A. Raftery,
///         M. Karny and P. Ettler, "Online prediction under model uncertainty via dynamic model
///         averaging", 2010 (weights by likelihood, with forgetting).
class PooledPerceptionModel final : public PerceptionModel {
 public:
  static constexpr double kMemory = 0.98;

  PooledPerceptionModel(std::shared_ptr<PerceptionModel> first,
                        std::shared_ptr<PerceptionModel> second)
      : first_(std::move(first)), second_(std::move(second)) {}

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  void ReceivedEdits(const PerceptionQuery& query, const BeliefGrid& after) override;
  /// Both weights: "auto: 50 % nhpm, 50 % glpf", and the first one's version; no checksum.
  ModelIdentity identity() const override;

  double second_weight() const;  // in [0, 1]

 private:
  std::shared_ptr<PerceptionModel> first_;
  std::shared_ptr<PerceptionModel> second_;
  mutable std::mutex mutex_;  // guards all below
  double lead_ = 0.0;         // of the second, nats
  ModelIdentity against_;     // the first one in that comparison
};

}  // namespace conav::nhpm
