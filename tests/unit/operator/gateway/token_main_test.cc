#include <catch2/catch.hpp>

#include "operator/gateway/access.h"
#include "support/program_runner.h"

namespace conav::operators {
namespace {

TEST_CASE("a token that was made lets in until it is revoked, and is shown once",
          "[operator][gateway]") {
  const test::ProgramRunner runner("conav-token");
  const auto made = runner.Run("add anna --role operator --days 2");
  REQUIRE(made.exit_code == 0);
  const std::string token = made.out.substr(0, made.out.find('\n'));
  CHECK(token.size() == 32);
  AccessControl access(runner / "tokens.json");
  const auto admitted = access.Admit(token, "192.0.2.1", {});
  REQUIRE(admitted);
  CHECK(admitted->name == "anna");
  CHECK(admitted->role == console::ROLE_OPERATOR);
  const double ends_s = ReadTokens(runner / "tokens.json").value().at(0).ends_s;
  CHECK(ends_s == Approx(WallSeconds() + 2 * 86400.0).margin(100.0));

  REQUIRE(runner.Run("add ben --role observer").exit_code == 0);
  CHECK(runner.Run("add anna --role admin").exit_code == 2);  // she has one
  const auto listed = runner.Run("list");
  CHECK(listed.exit_code == 0);
  CHECK_THAT(listed.out,
             Catch::Contains("anna") && Catch::Contains("observer") && !Catch::Contains(token));
  CHECK(runner.Run("revoke anna").exit_code == 0);
  CHECK(runner.Run("revoke anna").exit_code == 2);
  CHECK_FALSE(access.Admit(token, "192.0.2.1", {}));
  CHECK_THAT(runner.Run("list").out, Catch::Contains("ben") && !Catch::Contains("anna"));
}

TEST_CASE("wrong use of conav token is refused before anything is written", "[operator][gateway]") {
  const test::ProgramRunner runner("conav-token");
  for (const char* arguments :
       {"", "add", "add anna", "add anna --role king", "add an/na --role admin", "list",
        "add anna --role admin --days nan", "revoke anna", "add '' --role admin"}) {
    CAPTURE(arguments);
    CHECK(runner.Run(arguments).exit_code == 2);
  }
  CHECK_FALSE(std::filesystem::exists(runner / "tokens.json"));
}

}  // namespace
}  // namespace conav::operators
