#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "common/msg/perception_model.h"

namespace conav::planner {

/// Remembers the answers of another model, also from one decision to the next.
///
/// The key is what a model may look at: the belief, the cells of the path as a set, the camera's
/// cell and heading, and the cells that the view shows. The order of the path is not part of it:
/// paths that wander differently over the same cells share an answer. The heading is: the network
/// sees how deep in the picture a cell is. The view's content is in the key, so a map that grows
/// makes new questions.
/// An answer is the very one that the other model gave; when the model that answers changes
/// (PerceptionModel::identity), all are forgotten. Answers that came while it changed are not
/// remembered; where some of their batch were, all of it is asked again, once.
///
/// Only what is not remembered is asked, as one batch, each distinct question once. Failures are
/// passed on and not remembered. The oldest answers are dropped beyond `capacity`.
/// Threads: as PerceptionModel; the other model is asked without a lock, so two threads may ask it
/// the same.
class CachedPerceptionModel final : public PerceptionModel {
 public:
  struct Counts {
    std::uint64_t asked = 0;   // queries passed on to the other model
    std::uint64_t cached = 0;  // queries answered from memory, or by a repeat in the same batch
    std::uint64_t calls = 0;   // calls of the other model
  };

  /// `capacity` in answers, at least 1; one takes about 13 bytes per cell of the belief.
  explicit CachedPerceptionModel(std::shared_ptr<PerceptionModel> model,
                                 std::size_t capacity = 8192);

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override;
  ModelIdentity identity() const override { return model_->identity(); }

  Counts counts() const;

 private:
  using Key = std::string;  // of bytes
  using AnswerPtr = std::shared_ptr<const PerceptionAnswer>;

  /// What is remembered of a batch; null where nothing is.
  struct Found {
    ModelIdentity identity;  // of the model that the answers are of
    std::vector<AnswerPtr> answers;
  };

  static Key KeyOf(const PerceptionQuery& query);
  Found LookUp(const std::vector<Key>& keys);
  Result<bool> AskMissing(std::span<const PerceptionQuery> queries, const std::vector<Key>& keys,
                          Found& found);
  Result<std::vector<AnswerPtr>> AskModel(const std::vector<PerceptionQuery>& queries);
  void ForgetIfModelChangedLocked();
  void RememberLocked(const Key& key, AnswerPtr answer);

  std::shared_ptr<PerceptionModel> model_;
  std::size_t capacity_;
  mutable std::mutex mutex_;  // guards all below
  std::unordered_map<Key, AnswerPtr> answers_;
  std::deque<const Key*> oldest_first_;  // keys of answers_
  ModelIdentity identity_;               // of the model that gave them
  Counts counts_;
};

}  // namespace conav::planner
