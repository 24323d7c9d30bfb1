#include "nhpm/model/pooled_model.h"

#include <fmt/core.h>

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

double LogOdds(float probability) {
  const double p = std::clamp(static_cast<double>(probability), 1e-7, 1.0 - 1e-7);
  return std::log(p / (1.0 - p));
}

void Pool(const Grid<float>& second, double weight, Grid<float>& first) {
  for (std::size_t i = 0; i < first.size(); ++i) {
    float& p = first.values()[i];
    const float q = second.values()[i];
    if (p == 0.0F || q == 0.0F) {  // masked
      p = 0.0F;
    } else {
      p = static_cast<float>(1.0 / (1.0 + std::exp(-std::lerp(LogOdds(p), LogOdds(q), weight))));
    }
  }
}

}  // namespace

Result<std::vector<PerceptionAnswer>> PooledPerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  const double weight = second_weight();
  auto answers = first_->Predict(queries);
  if (!answers) return answers;
  const auto others = second_->Predict(queries);
  if (!others) return others;
  for (std::size_t i = 0; i < answers->size(); ++i) {
    Pool((*others)[i].add, weight, (*answers)[i].add);
    Pool((*others)[i].remove, weight, (*answers)[i].remove);
  }
  return answers;
}

void PooledPerceptionModel::ReceivedEdits(const PerceptionQuery& query, const BeliefGrid& after) {
  const BeliefGrid& before = query.belief;
  if (before.rows() != after.rows() || before.columns() != after.columns()) return;
  const ModelIdentity asked = first_->identity();
  const auto first = first_->Predict({&query, 1});
  const auto second = second_->Predict({&query, 1});
  if (!first || !second || first_->identity() != asked) return;
  const double gain =
      LogLikelihood(second->front(), before, after) - LogLikelihood(first->front(), before, after);
  const std::lock_guard lock(mutex_);
  if (asked != against_) lead_ = 0.0;
  against_ = asked;
  lead_ = kMemory * lead_ + gain;
}

ModelIdentity PooledPerceptionModel::identity() const {
  ModelIdentity identity = first_->identity();
  const long percent = std::lround(100.0 * second_weight());
  identity.name = fmt::format("auto: {} % {}, {} % {}", 100 - percent, identity.name, percent,
                              second_->identity().name);
  identity.checksum.clear();
  return identity;
}

double PooledPerceptionModel::second_weight() const {
  const std::lock_guard lock(mutex_);
  return std::round(100.0 / (1.0 + std::exp(-lead_))) / 100.0;
}

}  // namespace conav::nhpm
