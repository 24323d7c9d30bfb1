#pragma once

#include <string>
#include <vector>

#include "common/runtime/config.h"

namespace conav::operators {

/// Section `operator.task:`, for those who let people take part in something
/// (docs/mapping-task.md). All robots are then in one world.
struct TaskOptions {
  /// "mapping" = one maze of the mapping task; "study" = one maze with the method of the planners;
  /// empty = none, robots are supervised.
  std::string kind;
  std::string participant;  // a pseudonym
  int number = 1;           // which of the mazes or parts, for the page
  int count = 1;            // of mazes or parts
  /// Mapping accuracies of the mazes before, for the page.
  std::vector<double> earlier;
  /// JSON file that the result is written to when the maze is finished; with one of a maze that was
  /// finished before, the service takes it as finished.
  std::string result;

  bool on() const { return !kind.empty(); }
  void Visit(ConfigReader& reader) {
    reader.Choice("kind", kind, {"", "mapping", "study"});
    reader.Field("participant", participant);
    reader.Field("number", number, 1, 1000);
    reader.Field("count", count, 1, 1000);
    if (number > count) reader.Refuse("number", "is above count");
    reader.Field("earlier", earlier);
    reader.Field("result", result);
    if (on() && result.empty()) reader.Refuse("result", "names no file");
  }
};

}  // namespace conav::operators
