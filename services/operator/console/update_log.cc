#include "operator/console/update_log.h"

#include <algorithm>
#include <utility>

#include "operator/console/console_messages.h"

namespace conav::operators {

void UpdateLog::Put(std::string_view key, console::Update update) {
  const std::lock_guard lock(mutex_);
  PutLocked(key, update);
}

void UpdateLog::Put(std::string_view key, console::Update update, std::string_view group,
                    std::size_t keep) {
  const std::lock_guard lock(mutex_);
  PutLocked(key, update);
  std::deque<std::string>& keys = groups_[std::string(group)];
  if (std::ranges::find(keys, key) != keys.end()) return;
  keys.emplace_back(key);
  while (keys.size() > keep) {
    EraseLocked(keys.front());
    keys.pop_front();
  }
}

void UpdateLog::PutLocked(std::string_view key, console::Update& update) {
  EraseLocked(std::string(key));
  update.set_sequence(++sequence_);
  std::string encoded = EncodeUpdate(update);
  bytes_ += encoded.size();
  sequence_of_[std::string(key)] = sequence_;
  const Reader reader = update.has_study_log() ? Reader::kExperimenter : Reader::kAnyone;
  entries_.emplace_hint(entries_.end(), sequence_,
                        Entry{std::string(key), std::move(encoded), reader});
}

void UpdateLog::EraseLocked(const std::string& key) {
  const auto found = sequence_of_.find(key);
  if (found == sequence_of_.end()) return;
  const auto entry = entries_.find(found->second);
  bytes_ -= entry->second.encoded.size();
  entries_.erase(entry);
  sequence_of_.erase(found);
}

void UpdateLog::Forget(const std::function<bool(std::string_view)>& is_void) {
  const std::lock_guard lock(mutex_);
  ++generation_;
  std::erase_if(entries_, [&](const auto& numbered) {
    const Entry& entry = numbered.second;
    if (!is_void(entry.key)) return false;
    bytes_ -= entry.encoded.size();
    sequence_of_.erase(entry.key);
    return true;
  });
  for (auto& [group, keys] : groups_) {
    std::erase_if(keys, [this](const std::string& key) { return !sequence_of_.contains(key); });
  }
}

void UpdateLog::Clear() {
  Forget([](std::string_view) { return true; });
}

void UpdateLog::Pause(bool held) {
  const std::lock_guard lock(mutex_);
  held_ = held;
}

UpdateLog::Batch UpdateLog::After(std::uint64_t generation, std::uint64_t sequence,
                                  std::size_t size_limit, Reader reader) const {
  const std::lock_guard lock(mutex_);
  if (held_) return {{}, sequence, generation, false};
  Batch batch{{}, sequence, generation_, false};
  auto entry = generation == generation_ ? entries_.upper_bound(sequence) : entries_.begin();
  for (; entry != entries_.end(); ++entry) {
    if (entry->second.reader == Reader::kExperimenter && reader == Reader::kAnyone) continue;
    const std::string& encoded = entry->second.encoded;
    batch.more = !batch.updates.empty() && batch.updates.size() + encoded.size() > size_limit;
    if (batch.more) break;
    batch.updates += encoded;
    batch.sequence = entry->first;
  }
  return batch;
}

std::uint64_t UpdateLog::generation() const {
  const std::lock_guard lock(mutex_);
  return generation_;
}

std::uint64_t UpdateLog::sequence() const {
  const std::lock_guard lock(mutex_);
  return sequence_;
}

std::size_t UpdateLog::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace conav::operators
