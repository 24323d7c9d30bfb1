#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "planner/search/perception_model.h"

namespace conav::planner {

/// Remembers the answers of another model. The key is the whole content of a query (belief, path in
/// its order, cell, heading, view), so an answer is the very one that the other model gave.
///
/// Only what is not remembered is asked, as one batch, each distinct query once. Failures are
/// passed on and not remembered. The oldest answers are dropped beyond `capacity`.
/// Worth it before a model of milliseconds; conav-planner does without (docs/architecture.md).
/// Threads: as PerceptionModel; the other model is asked without a lock, so two threads may ask it
/// the same.
class CachedPerceptionModel final : public PerceptionModel {
 public:
  struct Counts {
    std::uint64_t asked = 0;   // queries passed on to the other model
    std::uint64_t cached = 0;  // queries answered from memory, or by a repeat in the same batch
    std::uint64_t calls = 0;   // calls of the other model
  };

  /// `capacity` in answers, at least 1; one takes about 12 bytes per cell of the belief.
  explicit CachedPerceptionModel(std::shared_ptr<PerceptionModel> model,
                                 std::size_t capacity = 8192);

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  std::string name() const override { return model_->name(); }

  Counts counts() const;

 private:
  struct QueryHash {
    std::size_t operator()(const PerceptionQuery& query) const;
  };
  using AnswerPtr = std::shared_ptr<const PerceptionAnswer>;

  std::vector<AnswerPtr> LookUp(std::span<const PerceptionQuery> queries);
  void Remember(const PerceptionQuery& query, AnswerPtr answer);

  std::shared_ptr<PerceptionModel> model_;
  std::size_t capacity_;
  mutable std::mutex mutex_;  // guards all below
  std::unordered_map<PerceptionQuery, AnswerPtr, QueryHash> answers_;
  std::deque<const PerceptionQuery*> oldest_first_;  // keys of answers_
  Counts counts_;
};

}  // namespace conav::planner
