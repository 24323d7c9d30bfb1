#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "common/msg/perception_model.h"

namespace conav::nhpm {

/// share a + (1 - share) b, cell by cell.
std::vector<PerceptionAnswer> Mix(double share, std::vector<PerceptionAnswer> a,
                                  const std::vector<PerceptionAnswer>& b);

/// The mean of two models, weighed by how well each has predicted this person's edits so far: equally
/// at first, then by the posterior probabilities, from the log likelihoods of all unmasked outputs.
/// Pictures fade from the comparison, each to kMemory with the next one. So a stranger soon gets the
/// model that fits, and until then is not left to one that is sure and wrong.
///
/// Threads: as PerceptionModel.
class WeighedPerceptionModel final : public PerceptionModel {
 public:
  static constexpr double kMemory = 0.98;

  WeighedPerceptionModel(std::shared_ptr<PerceptionModel> first,
                         std::shared_ptr<PerceptionModel> second)
      : first_(std::move(first)), second_(std::move(second)) {}

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  [[nodiscard]] Result<std::vector<double>> PredictEdits(const SharedBelief& belief,
                                                         std::span<const ShownView> views) override;
  /// A picture that one of the models cannot answer says nothing.
  void ReceivedEdits(const PerceptionQuery& query, const BeliefGrid& after) override;
  /// Name: "auto: " and the name of the model with the larger share; the version says how large.
  ModelIdentity identity() const override;

  /// Of the first, in [0, 1].
  double share() const;

 private:
  std::shared_ptr<PerceptionModel> first_;
  std::shared_ptr<PerceptionModel> second_;
  mutable std::mutex mutex_;  // guards lead_
  double lead_ = 0.0;         // of the first, in nats
};

}  // namespace conav::nhpm
