#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "common/msg/perception_model.h"
#include "common/runtime/clock.h"

namespace conav::planner {

/// Remembers the edits that another model predicts, also from one decision to the next, until the
/// belief changes. Predict() is passed on: a planner asks it of each picture once.
///
/// The key is the rest of what a model may look at: the camera's cell and heading, and the cells of
/// the path and of the view.
/// When the model that answers changes (PerceptionModel::identity), all are forgotten. What came
/// while it changed is not remembered; where some of a batch were, all of it is asked again, once.
///
/// Only what is not remembered is asked, as one batch, each distinct view once. Failures are
/// passed on and not remembered. Beyond the limit the oldest are dropped.
/// Threads: as PerceptionModel; the other model is asked without a lock, so two threads may ask it
/// the same.
class CachedPerceptionModel final : public PerceptionModel {
 public:
  struct Counts {
    std::uint64_t asked = 0;   // views passed on to the other model
    std::uint64_t cached = 0;  // views answered from memory, or by a repeat in the same batch
    std::uint64_t calls = 0;   // calls of the other model
    std::size_t bytes = 0;     // remembered now
  };

  static constexpr std::size_t kLimitBytes = std::size_t{128} << 20;

  /// `limit_bytes` for all that is remembered; a view takes about 8 bytes per cell that it has.
  explicit CachedPerceptionModel(std::shared_ptr<PerceptionModel> model,
                                 std::size_t limit_bytes = kLimitBytes);

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override {
    return model_->Predict(queries);
  }
  [[nodiscard]] Result<std::vector<double>> PredictEdits(const SharedBelief& belief,
                                                         std::span<const ShownView> views) override;
  void ReceivedEdits(const PerceptionQuery& query, const BeliefGrid& after) override {
    model_->ReceivedEdits(query, after);
  }
  ModelIdentity identity() const override { return model_->identity(); }

  Counts counts() const;

 private:
  using Key = std::string;  // of bytes

  /// What is remembered of a batch.
  struct Found {
    ModelIdentity identity;  // of the model that the edits are of
    std::vector<std::optional<double>> edits;
  };

  std::vector<Key> KeysOf(const SharedBelief& belief, std::span<const ShownView> views);
  Found LookUp(const std::vector<Key>& keys);
  Result<bool> AskMissing(const SharedBelief& belief, std::span<const ShownView> views,
                          const std::vector<Key>& keys, Found& found);
  void ForgetIfModelChangedLocked();
  void ForgetLocked();
  void RememberLocked(const Key& key, double edits);

  std::shared_ptr<PerceptionModel> model_;
  std::size_t limit_bytes_;
  mutable std::mutex mutex_;  // guards all below
  std::unordered_map<Key, double> edits_;
  std::deque<const Key*> oldest_first_;  // keys of edits_
  SharedBelief belief_;                  // of the newest PredictEdits()
  std::uint64_t belief_number_ = 0;      // of those before that differ
  ModelIdentity identity_;               // of the model that gave them
  Counts counts_;
};

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
  [[nodiscard]] Result<std::vector<double>> PredictEdits(const SharedBelief& belief,
                                                         std::span<const ShownView> views) override;
  /// The primary's, or while fallen back the other's with "fallback: " before its name.
  ModelIdentity identity() const override;

 private:
  enum class Attempt { kNone, kNormal, kProbe };
  template <class Ask>
  auto AskEither(const Ask& ask);
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
