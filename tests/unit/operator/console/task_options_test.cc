#include <yaml-cpp/yaml.h>

#include <catch2/catch.hpp>

#include "operator/console/participant_task.h"

namespace conav::operators {
namespace {

TaskOptions Read(const std::string& yaml) {
  TaskOptions options;
  ReadConfig(YAML::Load(yaml), "operator.task", options);
  return options;
}

}  // namespace

TEST_CASE("without a kind there is no task", "[operator][task]") {
  CHECK_FALSE(Read("{}").on());
  CHECK(Read("{kind: study, result: result.json}").on());
}

TEST_CASE("a task that cannot be is refused by its key", "[operator][task]") {
  using Catch::Contains;
  CHECK_THROWS_WITH(Read("{kind: game, result: r.json}"), Contains("operator.task.kind"));
  CHECK_THROWS_WITH(Read("{kind: mapping}"), Contains("operator.task.result"));
  CHECK_THROWS_WITH(Read("{number: 3, count: 2}"), Contains("operator.task.number"));
  CHECK_THROWS_WITH(Read("{number: 0}"), Contains("operator.task.number"));
  CHECK_THROWS_WITH(Read("{earlier: [0.5, 1.5]}"), Contains("operator.task.earlier"));
  CHECK_THROWS_WITH(Read("{earlier: [.nan]}"), Contains("operator.task.earlier"));
  CHECK_THROWS_WITH(Read("{participant: a/b}"), Contains("operator.task.participant"));
}

}  // namespace conav::operators
