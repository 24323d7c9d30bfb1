#include "planner/perception/cached_model.h"

#include <cstring>

#include "common/runtime/result.h"

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
  Found found = LookUp(keys);
  auto of_one_model = AskMissing(queries, keys, found);
  if (of_one_model && !*of_one_model) {
    found = {model_->identity(), std::vector<AnswerPtr>(keys.size())};
    of_one_model = AskMissing(queries, keys, found);
  }
  if (!of_one_model) return tl::unexpected(of_one_model.error());
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  for (const AnswerPtr& answer : found.answers) answers.push_back(*answer);
  return answers;
}

/// Fills in what was not found. False when what was found may be another model's than the rest.
Result<bool> CachedPerceptionModel::AskMissing(std::span<const PerceptionQuery> queries,
                                               const std::vector<Key>& keys, Found& found) {
  // Distinct queries that are not remembered, and which of them answers each position.
  std::vector<PerceptionQuery> missing;
  std::vector<const Key*> missing_keys;
  std::vector<std::size_t> missing_index(queries.size());
  std::unordered_map<Key, std::size_t> index_of_key;
  bool any_found = false;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    any_found |= found.answers[i] != nullptr;
    if (found.answers[i]) continue;
    const auto [entry, is_new] = index_of_key.try_emplace(keys[i], missing.size());
    missing_index[i] = entry->second;
    if (!is_new) continue;
    missing.push_back(queries[i]);
    missing_keys.push_back(&keys[i]);
  }
  auto fresh = AskModel(missing);
  if (!fresh) return tl::unexpected(fresh.error());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (!found.answers[i]) found.answers[i] = (*fresh)[missing_index[i]];
  }

  const std::lock_guard lock(mutex_);
  counts_.asked += missing.size();
  counts_.calls += missing.empty() ? 0 : 1;
  ForgetIfModelChangedLocked();
  const bool same_model = missing.empty() || identity_ == found.identity;
  if (!same_model && any_found) return false;
  counts_.cached += queries.size() - missing.size();
  // While the model changed nobody knows which one gave these answers.
  if (!same_model) return true;
  for (std::size_t i = 0; i < missing.size(); ++i) RememberLocked(*missing_keys[i], (*fresh)[i]);
  return true;
}

Result<std::vector<CachedPerceptionModel::AnswerPtr>> CachedPerceptionModel::AskModel(
    const std::vector<PerceptionQuery>& queries) {
  std::vector<AnswerPtr> kept;
  if (queries.empty()) return kept;
  auto answers = model_->Predict(queries);
  if (!answers) return tl::unexpected(answers.error());
  DEMAND(answers->size() == queries.size(), answers->size(), queries.size());
  for (PerceptionAnswer& answer : *answers) {
    kept.push_back(std::make_shared<const PerceptionAnswer>(std::move(answer)));
  }
  return kept;
}

CachedPerceptionModel::Counts CachedPerceptionModel::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

CachedPerceptionModel::Found CachedPerceptionModel::LookUp(const std::vector<Key>& keys) {
  const std::lock_guard lock(mutex_);
  ForgetIfModelChangedLocked();
  Found found{identity_, std::vector<AnswerPtr>(keys.size())};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (const auto it = answers_.find(keys[i]); it != answers_.end()) found.answers[i] = it->second;
  }
  return found;
}

void CachedPerceptionModel::ForgetIfModelChangedLocked() {
  ModelIdentity identity = model_->identity();
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
