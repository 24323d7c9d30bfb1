#include "study/design.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>
#include <tuple>

namespace conav::study {
namespace {

/// How often each condition is at each place, and right after each other one.
void CheckBalanced(const std::vector<std::vector<int>>& orders, int conditions) {
  std::map<std::pair<int, std::size_t>, int> at_place;
  std::map<std::pair<int, int>, int> after;
  for (const auto& order : orders) {
    std::vector<int> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (int i = 0; i < conditions; ++i) REQUIRE(sorted[static_cast<std::size_t>(i)] == i);
    for (std::size_t place = 0; place < order.size(); ++place) {
      ++at_place[{order[place], place}];
      if (place > 0) ++after[{order[place - 1], order[place]}];
    }
  }
  const int rows = static_cast<int>(orders.size());
  CHECK(at_place.size() == static_cast<std::size_t>(conditions * conditions));
  for (const auto& [key, count] : at_place) CHECK(count == rows / conditions);
  CHECK(after.size() == static_cast<std::size_t>(conditions * (conditions - 1)));
  for (const auto& [key, count] : after) CHECK(count == rows / conditions);
}

TEST_CASE("A Williams design balances places and followers for even and odd numbers", "[study]") {
  for (const int conditions : {2, 3, 4, 5, 6, 7, 8}) {
    CAPTURE(conditions);
    const auto orders = WilliamsDesign(conditions);
    CHECK(orders.size() ==
          static_cast<std::size_t>(conditions % 2 == 0 ? conditions : 2 * conditions));
    CheckBalanced(orders, conditions);
  }
  CHECK(WilliamsDesign(1) == std::vector<std::vector<int>>{{0}});
}

TEST_CASE("Everybody has every method once on every layout", "[study]") {
  const Design design = MakeDesign({});
  REQUIRE(design.episodes.size() == 126);
  CHECK(design.layouts == std::vector<std::uint64_t>{234, 666, 9});
  CHECK(design.subjects.front() == "s01");
  std::set<std::tuple<int, std::string, std::uint64_t>> seen;
  std::set<std::string> names;
  std::set<std::uint64_t> seeds;
  for (const PlannedEpisode& episode : design.episodes) {
    seen.insert({episode.subject, episode.method, episode.maze_seed});
    names.insert(episode.name);
    seeds.insert(episode.seed);
    CHECK(episode.method == design.orders[static_cast<std::size_t>(episode.subject)]
                                         [static_cast<std::size_t>(episode.session)]);
  }
  CHECK(seen.size() == 126);
  CHECK(names.size() == 126);
  CHECK(seeds.size() == 126);
  for (const int block : {0, 6}) {  // every order of the design once
    CHECK(std::set(design.orders.begin() + block, design.orders.begin() + block + 6).size() == 6);
  }
}

TEST_CASE("Nobody sees a layout twice the same way round, and methods share the orientations",
          "[study]") {
  for (const std::size_t methods : {1, 2, 3, 4}) {
    DesignOptions options{.operators = 5, .layouts = 4};
    options.methods = {"a", "b", "c", "d"};
    options.methods.resize(methods);
    std::set<std::tuple<int, std::uint64_t, int>> seen;
    for (const PlannedEpisode& episode : MakeDesign(options).episodes) {
      CHECK(seen.insert({episode.subject, episode.maze_seed, episode.rotation_deg}).second);
      CHECK(episode.rotation_deg % 90 == 0);
      if (methods == 3) CHECK(episode.rotation_deg <= 180);
    }
  }
  std::map<std::pair<std::string, int>, int> count;  // over three whole blocks
  for (const PlannedEpisode& episode : MakeDesign({.operators = 18, .layouts = 1}).episodes) {
    ++count[{episode.method, episode.rotation_deg}];
  }
  CHECK(count.size() == 9);
  for (const auto& [key, times] : count) CHECK(times == 6);
}

TEST_CASE("The seed alone decides orders, layouts beyond the third, and episodes' seeds",
          "[study]") {
  const DesignOptions options{.operators = 6, .layouts = 5, .seed = 3};
  DesignOptions other = options;
  other.seed = 4;
  const Design design = MakeDesign(options);
  const Design same = MakeDesign(options);
  REQUIRE(design.layouts.size() == 5);
  CHECK(std::set<std::uint64_t>(design.layouts.begin(), design.layouts.end()).size() == 5);
  CHECK(same.orders == design.orders);
  CHECK(same.layouts == design.layouts);
  CHECK(same.episodes.back().seed == design.episodes.back().seed);
  CHECK(MakeDesign(other).layouts != design.layouts);
  CHECK(MakeDesign(other).episodes.back().seed != design.episodes.back().seed);
}

}  // namespace
}  // namespace conav::study
