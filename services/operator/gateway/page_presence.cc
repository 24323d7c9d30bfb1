#include "operator/gateway/page_presence.h"

#include <algorithm>

namespace conav::operators {

void PagePresence::Join(std::uint64_t page, const PageIdentity& who) {
  people_[page] = {who.client, who.name, who.role};
  left_at_.erase(who.client);
}

void PagePresence::Leave(std::uint64_t page, Clock::TimePoint now) {
  const auto found = people_.find(page);
  if (found == people_.end()) return;
  const std::string client = found->second.client;
  people_.erase(found);
  const bool is_here = std::any_of(people_.begin(), people_.end(), [&](const auto& entry) {
    return entry.second.client == client;
  });
  if (!is_here) left_at_[client] = now;
}

std::vector<std::string> PagePresence::TakeGone(Clock::TimePoint now) {
  std::vector<std::string> gone;
  for (const auto& [client, at] : left_at_) {
    if (now - at >= kGoneAfter) gone.push_back(client);
  }
  for (const std::string& client : gone) left_at_.erase(client);
  return gone;
}

std::vector<Person> PagePresence::People() const {
  std::map<std::string, Person> by_client;
  for (const auto& [page, person] : people_) by_client[person.client] = person;
  std::vector<Person> people;
  for (const auto& [client, person] : by_client) people.push_back(person);
  return people;
}

std::string PagePresence::NameOf(const std::string& client) const {
  for (const auto& [page, person] : people_) {
    if (person.client == client) return person.name;
  }
  return "";
}

}  // namespace conav::operators
