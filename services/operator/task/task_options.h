#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/utf8.h"

namespace conav::operators {

/// Section `operator.task:`, for those who let people take part in something
/// (docs/mapping-task.md). All robots are then in one world.
struct TaskOptions {
  /// "mapping" = one maze of the mapping task; "study" = one maze with the method of the planners;
  /// empty = none, robots are supervised.
  std::string kind;
  std::string participant;  // a pseudonym, UTF-8 without slashes and control characters
  int number = 1;           // which of the mazes or parts, for the page
  int count = 1;            // of mazes or parts
  /// Mapping accuracies of the mazes before, 0 to 1, for the page.
  std::vector<double> earlier;
  /// JSON file that the result is written to when the maze is finished; with one of a maze that was
  /// finished before, the service takes it as finished.
  std::string result;

  bool on() const { return !kind.empty(); }
  void Visit(ConfigReader& reader) {
    reader.Choice("kind", kind, {"", "mapping", "study"});
    reader.Field("participant", participant);
    if (!IsPlainName(participant)) reader.Refuse("participant", kNoPlainName);
    reader.Field("number", number, 1, 1000);
    reader.Field("count", count, 1, 1000);
    if (number > count) reader.Refuse("number", "is above count");
    reader.Field("earlier", earlier);
    const auto is_share = [](double accuracy) { return accuracy >= 0.0 && accuracy <= 1.0; };
    if (!std::ranges::all_of(earlier, is_share)) {
      reader.Refuse("earlier", "has a value that is out of range [0, 1]");
    }
    reader.Field("result", result);
    if (on() && result.empty()) reader.Refuse("result", "names no file");
  }
};

}  // namespace conav::operators
