#include "planner/search/cached_perception_model.h"

#include <algorithm>
#include <bit>

#include "common/runtime/demand.h"

namespace conav::planner {
namespace {

/// FNV-1a over 64-bit words, with a shift so that high bits reach the low ones.
class Hash {
 public:
  void Add(std::uint64_t word) {
    state_ = (state_ ^ word) * 0x9e3779b97f4a7c15ULL;
    state_ ^= state_ >> 29;
  }
  void Add(Cell cell) {
    Add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(cell.row)) << 32 |
        static_cast<std::uint32_t>(cell.column));
  }
  void Add(const std::vector<Cell>& cells) {
    Add(cells.size());
    for (const Cell cell : cells) Add(cell);
  }
  std::size_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325ULL;
};

}  // namespace

std::size_t CachedPerceptionModel::QueryHash::operator()(const PerceptionQuery& query) const {
  Hash hash;
  hash.Add(query.cell);
  hash.Add(std::bit_cast<std::uint64_t>(query.heading_rad));
  for (const float value : query.belief.values()) hash.Add(std::bit_cast<std::uint32_t>(value));
  hash.Add(query.path);
  hash.Add(query.visible.free);
  hash.Add(query.visible.walls);
  return hash.value();
}

CachedPerceptionModel::CachedPerceptionModel(std::shared_ptr<PerceptionModel> model,
                                             std::size_t capacity)
    : model_(std::move(model)), capacity_(capacity) {
  DEMAND(model_ != nullptr && capacity_ >= 1, capacity_);
}

Result<std::vector<PerceptionAnswer>> CachedPerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  std::vector<AnswerPtr> found = LookUp(queries);

  // Distinct queries that are not remembered, and which of them answers each position.
  std::vector<PerceptionQuery> missing;
  std::vector<std::size_t> missing_index(queries.size());
  std::unordered_map<std::size_t, std::vector<std::size_t>> missing_of_hash;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (found[i]) continue;
    std::vector<std::size_t>& same_hash = missing_of_hash[QueryHash{}(queries[i])];
    const auto same = std::find_if(same_hash.begin(), same_hash.end(),
                                   [&](std::size_t index) { return missing[index] == queries[i]; });
    missing_index[i] = same == same_hash.end() ? missing.size() : *same;
    if (same != same_hash.end()) continue;
    same_hash.push_back(missing.size());
    missing.push_back(queries[i]);
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
  for (std::size_t i = 0; i < missing.size(); ++i) Remember(missing[i], fresh[i]);
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
    std::span<const PerceptionQuery> queries) {
  const std::lock_guard lock(mutex_);
  std::vector<AnswerPtr> found(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (const auto it = answers_.find(queries[i]); it != answers_.end()) found[i] = it->second;
  }
  return found;
}

void CachedPerceptionModel::Remember(const PerceptionQuery& query, AnswerPtr answer) {
  const auto [it, inserted] = answers_.emplace(query, std::move(answer));
  if (!inserted) return;
  oldest_first_.push_back(&it->first);
  if (answers_.size() <= capacity_) return;
  const auto oldest = answers_.find(*oldest_first_.front());
  oldest_first_.pop_front();
  answers_.erase(oldest);
}

}  // namespace conav::planner
