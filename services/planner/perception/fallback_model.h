#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "common/msg/perception_model.h"
#include "common/runtime/clock.h"

namespace conav::planner {

/// Asks one model, and another one while the first is gone.
///
/// A batch that the primary cannot answer (kTimeout, kUnavailable, and any other failure but
/// kInvalidArgument) is answered by the fallback. From then on the fallback answers at once; after
/// a pause one batch tries the primary again. The pause doubles with each try that fails, so that a
/// service which hangs costs little.
/// kInvalidArgument is passed on: the batch is one that no model can answer, found before anybody
/// was asked, and says nothing about the primary.
/// Threads: as PerceptionModel. `on_switch` is called on the thread whose batch noticed, without a
/// lock; once per switch.
class FallbackPerceptionModel final : public PerceptionModel {
 public:
  struct Options {
    std::chrono::nanoseconds first_pause = std::chrono::seconds(1);
    std::chrono::nanoseconds longest_pause = std::chrono::seconds(30);
  };
  /// The error that made it fall back; nothing when the primary is back.
  using OnSwitch = std::function<void(const std::optional<Error>& why)>;

  FallbackPerceptionModel(std::shared_ptr<PerceptionModel> primary,
                          std::shared_ptr<PerceptionModel> fallback, const Options& options,
                          const Clock& clock, OnSwitch on_switch);

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  /// The primary's, or while fallen back the other's with "fallback: " before its name.
  ModelIdentity identity() const override;

 private:
  enum class Attempt { kNone, kNormal, kProbe };
  /// Whether this batch should ask the primary; while fallen back one batch per pause probes.
  Attempt NextAttempt();
  void NotePrimaryAnswered();
  void NoteNotAsked(Attempt attempt);
  void NotePrimaryFailed(const Error& error, Attempt attempt);

  std::shared_ptr<PerceptionModel> primary_;
  std::shared_ptr<PerceptionModel> fallback_;
  Options options_;
  const Clock& clock_;
  OnSwitch on_switch_;
  mutable std::mutex mutex_;  // guards all below
  bool fallen_back_ = false;
  bool probing_ = false;
  std::chrono::nanoseconds pause_{0};
  Clock::TimePoint next_try_{};
};

}  // namespace conav::planner
