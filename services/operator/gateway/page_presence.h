#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/runtime/clock.h"
#include "operator/console/console_state.h"
#include "operator/gateway/page_event.h"

namespace conav::operators {

/// Who looks at the console now. A client that loads its page again, or loses its connection for a
/// moment, is two pages for a while, and has gone only when none of them has come back in time.
/// Pure; threads: not synchronised. `now`: wall time.
class PagePresence {
 public:
  /// A page that reconnects within this time keeps its client's control of robots.
  static constexpr std::chrono::seconds kGoneAfter{10};

  void Join(std::uint64_t page, const PageIdentity& who);
  void Leave(std::uint64_t page, Clock::TimePoint now);
  /// Clients without a page for kGoneAfter, each once.
  std::vector<std::string> TakeGone(Clock::TimePoint now);

  /// Each client once.
  std::vector<Person> People() const;
  /// As typed; empty for one who is not here.
  std::string NameOf(const std::string& client) const;

 private:
  std::map<std::uint64_t, Person> people_;           // by page
  std::map<std::string, Clock::TimePoint> left_at_;  // by client without a page
};

}  // namespace conav::operators
