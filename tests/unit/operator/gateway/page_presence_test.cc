#include <catch2/catch.hpp>

#include "operator/gateway/page_feed.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

const PageIdentity kAnnasPage{"anna/1", "Anna", console::ROLE_OPERATOR};
const PageIdentity kBertsPage{"bert/1", "Bert", console::ROLE_OBSERVER};

TEST_CASE("Each client is here once, however many pages it has for a moment",
          "[operator][console]") {
  PagePresence presence;
  presence.Join(1, kAnnasPage);
  presence.Join(2, kBertsPage);
  presence.Join(3, kAnnasPage);
  const auto people = presence.People();
  REQUIRE(people.size() == 2);
  CHECK(people[0] == Person{"anna/1", "Anna", console::ROLE_OPERATOR});
  CHECK(presence.NameOf("bert/1") == "Bert");
  CHECK(presence.NameOf("carl/1").empty());
}

TEST_CASE("A client has gone ten seconds after its last page, unless it came back",
          "[operator][console]") {
  PagePresence presence;
  const Clock::TimePoint start{};
  presence.Join(1, kAnnasPage);
  presence.Join(2, kAnnasPage);
  presence.Leave(1, start);
  CHECK(presence.TakeGone(start + 1h).empty());
  presence.Leave(2, start);
  CHECK(presence.People().empty());
  CHECK(presence.TakeGone(start + 9999ms).empty());
  CHECK(presence.TakeGone(start + 10s) == std::vector<std::string>{"anna/1"});
  CHECK(presence.TakeGone(start + 11s).empty());
  presence.Leave(1, start);
  presence.Join(2, kAnnasPage);
  CHECK(presence.TakeGone(start + 1h).empty());
  presence.Leave(7, start);  // one that never joined
  CHECK(presence.TakeGone(start + 1h).empty());
}

}  // namespace
}  // namespace conav::operators
