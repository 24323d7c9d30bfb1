#include "planner/search/cached_perception_model.h"

#include <cstring>

#include "common/runtime/demand.h"

namespace conav::planner {
namespace {

template <class T>
void Append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// One bit per cell of the grid: the same for every order and repetition of `cells`.
void AppendSet(std::string& bytes, const BeliefGrid& grid, const std::vector<Cell>& cells) {
  const std::size_t first = bytes.size();
  bytes.resize(first + (grid.size() + 7) / 8, '\0');
  for (const Cell cell : cells) {
    const auto index = static_cast<std::size_t>(cell.row * grid.columns() + cell.column);
    char& byte = bytes[first + index / 8];
    byte = static_cast<char>(byte | 1 << index % 8);
  }
}

}  // namespace

/// `query` passed CheckPerceptionQuery.
CachedPerceptionModel::Key CachedPerceptionModel::KeyOf(const PerceptionQuery& query) {
  const BeliefGrid& belief = query.belief;
  Key key;
  key.reserve(40 + belief.size() * sizeof(float) + belief.size() / 2);
  Append(key, belief.rows());
  Append(key, belief.columns());
  Append(key, query.cell.row);
  Append(key, query.cell.column);
  Append(key, query.heading_rad);
  key.append(reinterpret_cast<const char*>(belief.values().data()), belief.size() * sizeof(float));
  AppendSet(key, belief, query.path);
  AppendSet(key, belief, query.visible.free);
  AppendSet(key, belief, query.visible.walls);
  return key;
}

CachedPerceptionModel::CachedPerceptionModel(std::shared_ptr<PerceptionModel> model,
                                             std::size_t capacity)
    : model_(std::move(model)), capacity_(capacity) {
  DEMAND(model_ != nullptr && capacity_ >= 1, capacity_);
}

Result<std::vector<PerceptionAnswer>> CachedPerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  std::vector<Key> keys;
  keys.reserve(queries.size());
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
    keys.push_back(KeyOf(query));
  }
  std::vector<AnswerPtr> found = LookUp(keys);

  // Distinct queries that are not remembered, and which of them answers each position.
  std::vector<PerceptionQuery> missing;
  std::vector<const Key*> missing_keys;
  std::vector<std::size_t> missing_index(queries.size());
  std::unordered_map<Key, std::size_t> index_of_key;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (found[i]) continue;
    const auto [entry, is_new] = index_of_key.try_emplace(keys[i], missing.size());
    missing_index[i] = entry->second;
    if (!is_new) continue;
    missing.push_back(queries[i]);
    missing_keys.push_back(&keys[i]);
  }

  std::vector<AnswerPtr> fresh;
  if (!missing.empty()) {
    auto answers = model_->Predict(missing);
    if (!answers) return tl::unexpected(answers.error());
    DEMAND(answers->size() == missing.size(), answers->size(), missing.size());
    for (PerceptionAnswer& answer : *answers) {
      fresh.push_back(std::make_shared<const PerceptionAnswer>(std::move(answer)));
    }
  }

  const std::lock_guard lock(mutex_);
  counts_.asked += missing.size();
  counts_.cached += queries.size() - missing.size();
  counts_.calls += missing.empty() ? 0 : 1;
  ForgetIfModelChangedLocked();
  for (std::size_t i = 0; i < missing.size(); ++i) RememberLocked(*missing_keys[i], fresh[i]);
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    answers.push_back(found[i] ? *found[i] : *fresh[missing_index[i]]);
  }
  return answers;
}

CachedPerceptionModel::Counts CachedPerceptionModel::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

std::vector<CachedPerceptionModel::AnswerPtr> CachedPerceptionModel::LookUp(
    const std::vector<Key>& keys) {
  const std::lock_guard lock(mutex_);
  ForgetIfModelChangedLocked();
  std::vector<AnswerPtr> found(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (const auto it = answers_.find(keys[i]); it != answers_.end()) found[i] = it->second;
  }
  return found;
}

void CachedPerceptionModel::ForgetIfModelChangedLocked() {
  std::string identity = model_->identity();
  if (identity == identity_) return;
  identity_ = std::move(identity);
  oldest_first_.clear();
  answers_.clear();
}

void CachedPerceptionModel::RememberLocked(const Key& key, AnswerPtr answer) {
  const auto [it, inserted] = answers_.emplace(key, std::move(answer));
  if (!inserted) return;
  oldest_first_.push_back(&it->first);
  if (answers_.size() <= capacity_) return;
  const auto oldest = answers_.find(*oldest_first_.front());
  oldest_first_.pop_front();
  answers_.erase(oldest);
}

}  // namespace conav::planner
