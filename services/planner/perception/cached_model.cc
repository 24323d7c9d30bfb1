#include "planner/perception/cached_model.h"

#include "common/runtime/result.h"

namespace conav::planner {
namespace {

template <class T>
void Append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Of an entry with its place in the table and in the order.
std::size_t BytesOf(const std::string& key) {
  constexpr std::size_t kEntry = 168;
  return kEntry + key.capacity();
}

/// Of views of one belief; the orders of their cells are fixed.
std::string KeyOf(const ShownView& view, std::uint64_t belief) {
  std::string key;
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

}  // namespace

CachedPerceptionModel::CachedPerceptionModel(std::shared_ptr<PerceptionModel> model,
                                             std::size_t limit_bytes)
    : model_(std::move(model)), limit_bytes_(limit_bytes) {
  DEMAND(model_ != nullptr);
}

Result<std::vector<double>> CachedPerceptionModel::PredictEdits(const SharedBelief& belief,
                                                                std::span<const ShownView> views) {
  const std::vector<Key> keys = KeysOf(belief, views);
  Found found = LookUp(keys);
  auto of_one_model = AskMissing(belief, views, keys, found);
  if (of_one_model && !*of_one_model) {
    found = {model_->identity(), std::vector<std::optional<double>>(keys.size())};
    of_one_model = AskMissing(belief, views, keys, found);
  }
  if (!of_one_model) return tl::unexpected(of_one_model.error());
  std::vector<double> edits;
  for (const auto& of_view : found.edits) edits.push_back(*of_view);
  return edits;
}

/// Beliefs that follow each other have the same number if they are equal.
std::vector<CachedPerceptionModel::Key> CachedPerceptionModel::KeysOf(
    const SharedBelief& belief, std::span<const ShownView> views) {
  std::unique_lock lock(mutex_);
  if (belief_ != belief && (!belief_ || !(*belief_ == *belief))) {
    ++belief_number_;
    ForgetLocked();
  }
  belief_ = belief;
  const std::uint64_t number = belief_number_;
  lock.unlock();
  std::vector<Key> keys;
  keys.reserve(views.size());
  for (const ShownView& view : views) keys.push_back(KeyOf(view, number));
  return keys;
}

CachedPerceptionModel::Found CachedPerceptionModel::LookUp(const std::vector<Key>& keys) {
  const std::lock_guard lock(mutex_);
  ForgetIfModelChangedLocked();
  Found found{identity_, std::vector<std::optional<double>>(keys.size())};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const auto it = edits_.find(keys[i]);
    if (it != edits_.end()) found.edits[i] = it->second;
  }
  return found;
}

/// Fills in what was not found. False when what was found may be another model's than the rest.
Result<bool> CachedPerceptionModel::AskMissing(const SharedBelief& belief,
                                               std::span<const ShownView> views,
                                               const std::vector<Key>& keys, Found& found) {
  // Distinct views that are not remembered, and which of them answers each position.
  std::vector<ShownView> missing;
  std::vector<const Key*> missing_keys;
  std::vector<std::size_t> missing_index(views.size());
  std::unordered_map<Key, std::size_t> index_of_key;
  bool any_found = false;
  for (std::size_t i = 0; i < views.size(); ++i) {
    any_found |= found.edits[i].has_value();
    if (found.edits[i]) continue;
    const auto [entry, is_new] = index_of_key.try_emplace(keys[i], missing.size());
    missing_index[i] = entry->second;
    if (!is_new) continue;
    missing.push_back(views[i]);
    missing_keys.push_back(&keys[i]);
  }
  std::vector<double> fresh;
  if (!missing.empty()) {
    auto edits = model_->PredictEdits(belief, missing);
    if (!edits) return tl::unexpected(edits.error());
    DEMAND(edits->size() == missing.size(), edits->size(), missing.size());
    fresh = *std::move(edits);
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!found.edits[i]) found.edits[i] = fresh[missing_index[i]];
  }

  const std::lock_guard lock(mutex_);
  counts_.asked += missing.size();
  counts_.calls += missing.empty() ? 0 : 1;
  ForgetIfModelChangedLocked();
  const bool same_model = missing.empty() || identity_ == found.identity;
  if (!same_model && any_found) return false;
  counts_.cached += views.size() - missing.size();
  // While the model changed nobody knows which one gave these.
  if (!same_model) return true;
  for (std::size_t i = 0; i < missing.size(); ++i) RememberLocked(*missing_keys[i], fresh[i]);
  return true;
}

CachedPerceptionModel::Counts CachedPerceptionModel::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void CachedPerceptionModel::ForgetIfModelChangedLocked() {
  ModelIdentity identity = model_->identity();
  if (identity == identity_) return;
  identity_ = std::move(identity);
  ForgetLocked();
}

void CachedPerceptionModel::ForgetLocked() {
  edits_ = {};
  oldest_first_ = {};
  counts_.bytes = 0;
}

void CachedPerceptionModel::RememberLocked(const Key& key, double edits) {
  const auto [it, inserted] = edits_.emplace(key, edits);
  if (!inserted) return;
  oldest_first_.push_back(&it->first);
  counts_.bytes += BytesOf(it->first);
  while (counts_.bytes > limit_bytes_) {
    const auto oldest = edits_.find(*oldest_first_.front());
    counts_.bytes -= BytesOf(oldest->first);
    oldest_first_.pop_front();
    edits_.erase(oldest);
  }
}

}  // namespace conav::planner
