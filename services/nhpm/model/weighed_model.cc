#include "nhpm/model/weighed_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/grid/map_accuracy.h"

namespace conav::nhpm {
namespace {

/// Of what the person did, in nats, over the outputs that are not masked.
double LogLikelihood(const PerceptionAnswer& answer, const BeliefGrid& before,
                     const BeliefGrid& after) {
  double sum = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before.OnBorder(before.CellAt(i))) continue;
    const bool wall = before.values()[i] >= kWallThreshold;
    const bool edited = wall != (after.values()[i] >= kWallThreshold);
    const double p = std::clamp(
        static_cast<double>((wall ? answer.remove : answer.add).values()[i]), 1e-7, 1.0 - 1e-7);
    sum += std::log(edited ? p : 1.0 - p);
  }
  return sum;
}

}  // namespace

std::vector<PerceptionAnswer> Mix(double share, std::vector<PerceptionAnswer> a,
                                  const std::vector<PerceptionAnswer>& b) {
  const auto mix = [factor = static_cast<float>(share)](Grid<float>& to, const Grid<float>& from) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      to.values()[i] = factor * to.values()[i] + (1.0F - factor) * from.values()[i];
    }
  };
  for (std::size_t i = 0; i < a.size(); ++i) {
    mix(a[i].add, b[i].add);
    mix(a[i].remove, b[i].remove);
  }
  return a;
}

double WeighedPerceptionModel::share() const {
  const std::lock_guard lock(mutex_);
  return 1.0 / (1.0 + std::exp(-lead_));
}

Result<std::vector<PerceptionAnswer>> WeighedPerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  auto a = first_->Predict(queries);
  if (!a) return a;
  const auto b = second_->Predict(queries);
  if (!b) return b;
  return Mix(share(), std::move(*a), *b);
}

Result<std::vector<double>> WeighedPerceptionModel::PredictEdits(const SharedBelief& belief,
                                                                 std::span<const ShownView> views) {
  auto a = first_->PredictEdits(belief, views);
  if (!a) return a;
  const auto b = second_->PredictEdits(belief, views);
  if (!b) return b;
  const double factor = share();
  for (std::size_t i = 0; i < a->size(); ++i) {
    (*a)[i] = factor * (*a)[i] + (1.0 - factor) * (*b)[i];
  }
  return a;
}

void WeighedPerceptionModel::ReceivedEdits(const PerceptionQuery& query, const BeliefGrid& after) {
  const BeliefGrid& before = query.belief;
  if (before.rows() != after.rows() || before.columns() != after.columns()) return;
  const auto first = first_->Predict({&query, 1});
  const auto second = second_->Predict({&query, 1});
  if (!first || !second) return;
  const std::lock_guard lock(mutex_);
  lead_ = std::clamp(kMemory * lead_ + LogLikelihood(first->front(), before, after) -
                         LogLikelihood(second->front(), before, after),
                     -50.0, 50.0);
}

ModelIdentity WeighedPerceptionModel::identity() const {
  const double of_first = share();
  const bool first = of_first >= 0.5;
  ModelIdentity identity = (first ? first_ : second_)->identity();
  identity.name = "auto: " + identity.name;
  identity.checksum.clear();  // the share changes the bits
  identity.version =
      fmt::format("share {:.4f}, {}", first ? of_first : 1.0 - of_first, identity.version);
  return identity;
}

}  // namespace conav::nhpm
