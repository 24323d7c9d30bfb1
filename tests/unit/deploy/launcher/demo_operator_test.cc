#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "launcher/demo_plan.h"
#include "support/temporary_folder.h"

namespace conav::launcher {
namespace {

std::string Refusal(const std::string& simulated_operator) {
  DemoOptions options;
  options.simulated_operator = simulated_operator;
  const auto checked = CheckOperator(options);
  return checked ? "" : checked.error().text;
}

TEST_CASE("a kind of simulated operator is known by its name", "[launcher][operator]") {
  CHECK(OperatorPerson("hasty").planner.horizon == "next_goal");
  CHECK(OperatorPerson("silent").silent);
  for (const std::string& kind : operators::OperatorKinds()) CHECK(Refusal(kind).empty());
}

TEST_CASE("a file gives the person of its section", "[launcher][operator]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "anna.yaml";
  REQUIRE(WriteFile(file,
                    "simulated_operator:\n  ros__parameters:\n"
                    "    person: {kind: hasty, reader: {edit_limit: 9}}\n"));
  CHECK(Refusal(file.string()).empty());
  const auto person = OperatorPerson(file.string());
  CHECK(person.reader.edit_limit == 9);
  CHECK(person.planner.horizon == "next_goal");
}

TEST_CASE("who is neither a kind nor a good file is refused by the option's name",
          "[launcher][operator]") {
  CHECK(Refusal("lazy") ==
        "--operator lazy: neither a file nor one of careful, hasty, wrong, silent");
  const test::TemporaryFolder folder;
  const auto file = folder / "anna.yaml";
  REQUIRE(WriteFile(file, "simulated_operator:\n  ros__parameters:\n    person: {age: 30}\n"));
  CHECK_THAT(Refusal(file.string()),
             Catch::StartsWith("--operator ") && Catch::Contains("unknown key 'age'"));
}

}  // namespace
}  // namespace conav::launcher
