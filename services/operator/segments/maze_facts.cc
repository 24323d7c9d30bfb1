#include "operator/segments/maze_facts.h"

#include <fmt/format.h>

#include <charconv>

namespace conav::operators {

Result<std::map<std::string, MazeFacts>> ParseMazeFacts(const std::vector<std::string>& entries) {
  std::map<std::string, MazeFacts> facts;
  for (const std::string& entry : entries) {
    const auto equals = entry.find('=');
    const auto at = entry.rfind('@');
    const bool has_seed = at != std::string::npos && equals != std::string::npos && at > equals;
    MazeFacts maze;
    bool good = equals != std::string::npos && equals > 0;
    if (has_seed) {
      const char* end = entry.data() + entry.size();
      const auto parsed = std::from_chars(entry.data() + at + 1, end, maze.world_seed);
      good = good && parsed.ec == std::errc() && parsed.ptr == end;
    }
    if (!good) {
      return Fail(ErrorCode::kInvalidArgument,
                  fmt::format("'{}' is not WORLD=PRESET@SEED or WORLD=FILE", entry));
    }
    maze.corruption_seed = maze.world_seed;
    maze.name = entry.substr(equals + 1, has_seed ? at - equals - 1 : std::string::npos);
    facts.insert_or_assign(entry.substr(0, equals), maze);
  }
  return facts;
}

}  // namespace conav::operators
