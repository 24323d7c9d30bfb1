#include <algorithm>

#include "common/runtime/result.h"
#include "planner/perception/cached_model.h"

namespace conav::planner {

FallbackPerceptionModel::FallbackPerceptionModel(std::shared_ptr<PerceptionModel> primary,
                                                 std::shared_ptr<PerceptionModel> fallback,
                                                 const Options& options, const Clock& clock,
                                                 OnSwitch on_switch)
    : primary_(std::move(primary)),
      fallback_(std::move(fallback)),
      options_(options),
      clock_(clock),
      on_switch_(std::move(on_switch)) {
  DEMAND(primary_ && fallback_ && on_switch_);
}

template <class Ask>
auto FallbackPerceptionModel::AskEither(const Ask& ask) {
  const Attempt attempt = NextAttempt();
  if (attempt != Attempt::kNone) {
    auto answers = ask(*primary_);
    if (answers) {
      NotePrimaryAnswered();
      return answers;
    }
    if (answers.error().code == ErrorCode::kInvalidArgument) {
      NoteNotAsked(attempt);
      return answers;
    }
    NotePrimaryFailed(answers.error(), attempt);
  }
  return ask(*fallback_);
}

Result<std::vector<PerceptionAnswer>> FallbackPerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  return AskEither([&](PerceptionModel& model) { return model.Predict(queries); });
}

Result<std::vector<double>> FallbackPerceptionModel::PredictEdits(
    const SharedBelief& belief, std::span<const ShownView> views) {
  return AskEither([&](PerceptionModel& model) { return model.PredictEdits(belief, views); });
}

ModelIdentity FallbackPerceptionModel::identity() const {
  const std::lock_guard lock(mutex_);
  if (!fallen_back_) return primary_->identity();
  ModelIdentity identity = fallback_->identity();
  identity.name = "fallback: " + identity.name;
  return identity;
}

FallbackPerceptionModel::Attempt FallbackPerceptionModel::NextAttempt() {
  const std::lock_guard lock(mutex_);
  if (!fallen_back_) return Attempt::kNormal;
  const Clock::TimePoint now = clock_.Now();
  if (probing_ || now < next_try_) return Attempt::kNone;
  probing_ = true;  // other threads go on with the fallback meanwhile
  return Attempt::kProbe;
}

void FallbackPerceptionModel::NotePrimaryAnswered() {
  {
    const std::lock_guard lock(mutex_);
    if (!fallen_back_) return;
    fallen_back_ = false;
    probing_ = false;
  }
  on_switch_(std::nullopt);
}

void FallbackPerceptionModel::NoteNotAsked(Attempt attempt) {
  if (attempt != Attempt::kProbe) return;
  const std::lock_guard lock(mutex_);
  probing_ = false;
}

void FallbackPerceptionModel::NotePrimaryFailed(const Error& error, Attempt attempt) {
  {
    const std::lock_guard lock(mutex_);
    if (attempt == Attempt::kProbe) {
      probing_ = false;
      pause_ = std::min(pause_ * 2, options_.longest_pause);
    }
    const bool switched = !fallen_back_;
    if (switched) pause_ = options_.first_pause;
    fallen_back_ = true;
    next_try_ = clock_.Now() + pause_;
    if (!switched) return;
  }
  on_switch_(error);
}

}  // namespace conav::planner
