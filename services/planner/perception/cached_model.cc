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

std::size_t BytesOf(double) { return sizeof(double); }
std::size_t BytesOf(const PerceptionAnswer& answer) {
  return sizeof answer + (answer.add.size() + answer.remove.size()) * sizeof(float);
}

/// Of an entry with its place in the table and in the order.
template <class T>
std::size_t BytesOf(const std::string& key, const T& value) {
  constexpr std::size_t kEntry = 160;
  return kEntry + key.capacity() + BytesOf(value);
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

/// Of views of one belief; the orders of their cells are fixed.
CachedPerceptionModel::Key CachedPerceptionModel::KeyOf(const ShownView& view,
                                                        std::uint64_t belief) const {
  Key key;
  Append(key, belief);
  Append(key, view.heading_rad);
  const auto append_cells = [&](std::span<const Cell> cells) {
    Append(key, cells.size());
    key.append(reinterpret_cast<const char*>(cells.data()), cells.size() * sizeof(Cell));
  };
  append_cells({&view.cell, 1});
  append_cells(view.path);
  append_cells(view.visible.free);
  append_cells(view.visible.walls);
  return key;
}

CachedPerceptionModel::CachedPerceptionModel(std::shared_ptr<PerceptionModel> model,
                                             std::size_t limit_bytes)
    : model_(std::move(model)), limit_bytes_(limit_bytes) {
  DEMAND(model_ != nullptr);
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
  const auto found = Answer(
      queries, keys, answers_,
      [this](const std::vector<PerceptionQuery>& missing) { return model_->Predict(missing); });
  if (!found) return tl::unexpected(found.error());
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  for (const auto& answer : *found) answers.push_back(*answer);
  return answers;
}

Result<std::vector<double>> CachedPerceptionModel::PredictEdits(const SharedBelief& belief,
                                                                std::span<const ShownView> views) {
  const std::uint64_t number = NumberOf(belief);
  std::vector<Key> keys;
  keys.reserve(views.size());
  for (const ShownView& view : views) keys.push_back(KeyOf(view, number));
  const auto found = Answer(views, keys, edits_, [&](const std::vector<ShownView>& missing) {
    return model_->PredictEdits(belief, missing);
  });
  if (!found) return tl::unexpected(found.error());
  std::vector<double> edits;
  for (const auto& of_view : *found) edits.push_back(*of_view);
  return edits;
}

/// Beliefs that follow each other have the same number if they are equal.
std::uint64_t CachedPerceptionModel::NumberOf(const SharedBelief& belief) {
  const std::lock_guard lock(mutex_);
  if (belief_ != belief && (!belief_ || !(*belief_ == *belief))) {
    ++belief_number_;
    edits_ = {};
  }
  belief_ = belief;
  return belief_number_;
}

template <class T, class Question, class Ask>
Result<CachedPerceptionModel::Values<T>> CachedPerceptionModel::Answer(
    std::span<const Question> questions, const std::vector<Key>& keys, Memory<T>& memory,
    const Ask& ask) {
  Found<T> found = LookUp(keys, memory);
  auto of_one_model = AskMissing(questions, keys, memory, ask, found);
  if (of_one_model && !*of_one_model) {
    found = {model_->identity(), Values<T>(keys.size())};
    of_one_model = AskMissing(questions, keys, memory, ask, found);
  }
  if (!of_one_model) return tl::unexpected(of_one_model.error());
  return std::move(found.values);
}

/// Fills in what was not found. False when what was found may be another model's than the rest.
template <class T, class Question, class Ask>
Result<bool> CachedPerceptionModel::AskMissing(std::span<const Question> questions,
                                               const std::vector<Key>& keys, Memory<T>& memory,
                                               const Ask& ask, Found<T>& found) {
  // Distinct questions that are not remembered, and which of them answers each position.
  std::vector<Question> missing;
  std::vector<const Key*> missing_keys;
  std::vector<std::size_t> missing_index(questions.size());
  std::unordered_map<Key, std::size_t> index_of_key;
  bool any_found = false;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    any_found |= found.values[i] != nullptr;
    if (found.values[i]) continue;
    const auto [entry, is_new] = index_of_key.try_emplace(keys[i], missing.size());
    missing_index[i] = entry->second;
    if (!is_new) continue;
    missing.push_back(questions[i]);
    missing_keys.push_back(&keys[i]);
  }
  Values<T> fresh;
  if (!missing.empty()) {
    auto values = ask(missing);
    if (!values) return tl::unexpected(values.error());
    DEMAND(values->size() == missing.size(), values->size(), missing.size());
    for (T& value : *values) fresh.push_back(std::make_shared<const T>(std::move(value)));
  }
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (!found.values[i]) found.values[i] = fresh[missing_index[i]];
  }

  const std::lock_guard lock(mutex_);
  counts_.asked += missing.size();
  counts_.calls += missing.empty() ? 0 : 1;
  ForgetIfModelChangedLocked();
  const bool same_model = missing.empty() || identity_ == found.identity;
  if (!same_model && any_found) return false;
  counts_.cached += questions.size() - missing.size();
  // While the model changed nobody knows which one gave these answers.
  if (!same_model) return true;
  for (std::size_t i = 0; i < missing.size(); ++i) {
    RememberLocked(*missing_keys[i], fresh[i], memory);
  }
  return true;
}

CachedPerceptionModel::Counts CachedPerceptionModel::counts() const {
  const std::lock_guard lock(mutex_);
  Counts counts = counts_;
  counts.bytes = answers_.bytes + edits_.bytes;
  return counts;
}

template <class T>
CachedPerceptionModel::Found<T> CachedPerceptionModel::LookUp(const std::vector<Key>& keys,
                                                              const Memory<T>& memory) {
  const std::lock_guard lock(mutex_);
  ForgetIfModelChangedLocked();
  Found<T> found{identity_, Values<T>(keys.size())};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto it = memory.values.find(keys[i]);
    if (it != memory.values.end()) found.values[i] = it->second;
  }
  return found;
}

void CachedPerceptionModel::ForgetIfModelChangedLocked() {
  ModelIdentity identity = model_->identity();
  if (identity == identity_) return;
  identity_ = std::move(identity);
  answers_ = {};
  edits_ = {};
}

template <class T>
void CachedPerceptionModel::RememberLocked(const Key& key, std::shared_ptr<const T> value,
                                           Memory<T>& memory) {
  const auto [it, inserted] = memory.values.emplace(key, std::move(value));
  if (!inserted) return;
  memory.oldest_first.push_back(&it->first);
  memory.bytes += BytesOf(it->first, *it->second);
  while (answers_.bytes + edits_.bytes > limit_bytes_) {
    answers_.bytes > edits_.bytes ? DropOldest(answers_) : DropOldest(edits_);
  }
}

template <class T>
void CachedPerceptionModel::DropOldest(Memory<T>& memory) {
  const auto oldest = memory.values.find(*memory.oldest_first.front());
  memory.bytes -= BytesOf(oldest->first, *oldest->second);
  memory.oldest_first.pop_front();
  memory.values.erase(oldest);
}

}  // namespace conav::planner
