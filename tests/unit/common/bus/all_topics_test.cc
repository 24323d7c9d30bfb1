#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>
#include <string>
#include <vector>

#include "common/bus/topics.h"
#include "common/runtime/file.h"

namespace conav::bus {
namespace {

/// The patterns of all topics that the text of topics.h declares.
std::vector<std::string> DeclaredPatterns() {
  const auto text = ReadFile(std::string(CONAV_SOURCE_DIR) + "/services/common/bus/topics.h");
  REQUIRE(text);
  const std::regex declaration("constexpr Topic<[^>]*>\\s*k\\w+\\{\\s*\"([^\"]*)\"");
  std::vector<std::string> patterns;
  for (std::sregex_iterator at(text->begin(), text->end(), declaration), end; at != end; ++at) {
    patterns.push_back((*at)[1]);
  }
  return patterns;
}

std::vector<std::string> ListedPatterns() {
  std::vector<std::string> patterns;
  const auto add = [&](const auto& topic) { patterns.emplace_back(topic.pattern); };
  ForEachTopic(kRobotTopics, add);
  ForEachTopic(kWorldTopics, add);
  ForEachTopic(kSystemTopics, add);
  return patterns;
}

TEST_CASE("the lists of topics hold every topic that is declared, once", "[bus][topics]") {
  auto declared = DeclaredPatterns();
  auto listed = ListedPatterns();
  REQUIRE(declared.size() > 25);
  std::sort(declared.begin(), declared.end());
  std::sort(listed.begin(), listed.end());
  CHECK(listed == declared);
}

TEST_CASE("topics of robots and worlds have a place for their name, the others have none",
          "[bus][topics]") {
  const auto has_place = [](const auto& topic) { CHECK(topic.pattern.starts_with("/{}/")); };
  ForEachTopic(kRobotTopics, has_place);
  ForEachTopic(kWorldTopics, has_place);
  ForEachTopic(kSystemTopics, [](const auto& topic) {
    CHECK(topic.pattern.find("{}") == std::string_view::npos);
  });
}

}  // namespace
}  // namespace conav::bus
