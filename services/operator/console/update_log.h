#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "console.pb.h"

namespace conav::operators {

/// What a page of the console shows: the newest update of each key, in the order in which they
/// came.
///
/// Each page asks for what came after the update that it has, as fast as it takes it in. A page
/// that falls behind skips the updates that were replaced in the meantime, so that it never costs
/// more memory than what it is being sent, and one that comes back gets exactly what has changed.
/// Threads: safe to call concurrently.
class UpdateLog {
 public:
  /// The newest update of `key` from now on. Its sequence number is set here.
  void Put(std::string_view key, console::Update update);

  /// The same for a key that never changes its meaning, of which only the newest `keep` of `group`
  /// are kept: pictures, events. It belongs to the group from then on. A page that has an older one
  /// may keep it.
  void Put(std::string_view key, console::Update update, std::string_view group, std::size_t keep);

  /// Forgets the keys for which `is_void` holds, at the start of a new run. Pages forget
  /// everything, and get what is left and what comes then.
  void Forget(const std::function<bool(std::string_view)>& is_void);
  /// The same of all keys.
  void Clear();

  /// While one lives, pages get nothing: the updates of that time come together, without values
  /// that were replaced. One at a time.
  class Together {
   public:
    explicit Together(UpdateLog& log) : log_(log) { log_.Pause(true); }
    ~Together() { log_.Pause(false); }
    Together(const Together&) = delete;
    Together& operator=(const Together&) = delete;

   private:
    UpdateLog& log_;
  };

  struct Batch {
    std::string updates;         // body of a console::Updates; empty when there is nothing new
    std::uint64_t sequence = 0;  // of the newest update in it
    std::uint64_t generation = 0;
    bool more = false;  // there are others behind it
  };
  /// Who reads: a participant must not see what an experimenter writes about them.
  enum class Reader { kAnyone, kExperimenter };
  /// What came after `sequence` of `generation`, oldest first, at least one update and then up to
  /// `size_limit` bytes. Of another generation: from the beginning.
  Batch After(std::uint64_t generation, std::uint64_t sequence, std::size_t size_limit,
              Reader reader = Reader::kAnyone) const;

  /// Rises with each Forget() and Clear().
  std::uint64_t generation() const;
  /// Of the newest update ever put; goes on rising over them.
  std::uint64_t sequence() const;
  /// Of all updates, as pages get them.
  std::size_t bytes() const;

 private:
  struct Entry {
    std::string key;
    std::string encoded;  // as field `update` of console::Updates
    Reader reader = Reader::kAnyone;
  };

  void Pause(bool held);
  void PutLocked(std::string_view key, console::Update& update);
  void EraseLocked(const std::string& key);

  mutable std::mutex mutex_;  // guards all below
  bool held_ = false;
  std::uint64_t generation_ = 1;
  std::uint64_t sequence_ = 0;
  std::size_t bytes_ = 0;
  std::map<std::uint64_t, Entry> entries_;                              // by sequence number
  std::map<std::string, std::uint64_t, std::less<>> sequence_of_;       // by key
  std::map<std::string, std::deque<std::string>, std::less<>> groups_;  // keys, oldest first
};

}  // namespace conav::operators
