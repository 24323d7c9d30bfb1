#include "operator/gateway/access.h"

#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <functional>
#include <tuple>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"
#include "support/token_file.h"

namespace conav::operators {
namespace {

std::string CheckAllowed(const GatewayOptions& options) {
  const auto checked = CheckAccess(options);
  return checked ? "" : checked.error().text;
}

}  // namespace

// The faults report's S8: "Tokens without TLS are allowed on any address: token and robots in clear.
// No warning."
TEST_CASE("an address that others reach needs tokens, and TLS or a word that it may be without",
          "[operator][gateway]") {
  GatewayOptions options;
  CHECK(CheckAllowed(options).empty());
  options.address = GENERATE("127.0.0.1", "127.9.9.9", "::1");
  CHECK(CheckAllowed(options).empty());
  options.address = GENERATE("0.0.0.0", "192.168.1.2", "::", "fe80::1");
  options.insecure = true;
  CHECK_THAT(CheckAllowed(options), Catch::Contains("operator.console.token_file"));
  options.token_file = "tokens.json";
  CHECK(CheckAllowed(options).empty());
  options.insecure = false;
  CHECK_THAT(CheckAllowed(options),
             Catch::Contains("operator.console.tls") && Catch::Contains("--insecure"));
  options.tls = {"cert.pem", "key.pem"};
  CHECK(CheckAllowed(options).empty());
}

TEST_CASE("tokens in the configuration are refused without being printed", "[operator][gateway]") {
  GatewayOptions options;
  const YAML::Node node = YAML::Load("{tokens: {operator: operator-operator}}");
  CHECK_THROWS_WITH(ReadConfig(node, "operator.console", options),
                    Catch::Contains("conav token add") && !Catch::Contains("operator-operator"));
}

TEST_CASE("options that cannot work are refused by their name", "[operator][gateway]") {
  using Options = GatewayOptions;
  const std::vector<std::pair<std::function<void(Options&)>, const char*>> rows{
      {[](Options& o) { o.address = "localhost"; }, "operator.console.address"},
      {[](Options& o) { o.tls.certificate = "cert.pem"; }, "operator.console.tls"},
      {[](Options& o) { o.tls.key = "key.pem"; }, "operator.console.tls"}};
  for (const auto& [change, key] : rows) {
    Options options;
    change(options);
    CHECK_THAT(CheckAllowed(options), Catch::Contains(key));
  }
  for (const char* origin : {"console.example.org", "https://", "https://a.example/",
                             "https://A.example", "ftp://a.example", "https://me@a.example"}) {
    Options options;
    options.origins = {origin};
    CHECK_THAT(CheckAllowed(options), Catch::Contains("operator.console.origins"));
  }
}

// The faults report's S10: "One token per role: nobody can be told apart, no end, no change without
// restart; name is the client's word."
TEST_CASE("each token has a name, a role and an end, and is stored as a hash for its owner",
          "[operator][gateway]") {
  const test::TemporaryFolder folder;
  const auto file = test::TokenFile(folder / "tokens.json", 1000.0);
  CHECK(std::filesystem::status(file).permissions() == std::filesystem::perms{0600});
  CHECK_THAT(ReadFile(file).value(),
             Catch::Contains("otto") && !Catch::Contains("operator-operator"));
  double wall_s = 999.0;
  AccessControl access(file, [&] { return wall_s; });
  const Clock::TimePoint now{};
  for (const auto& [token, name, role] :
       {std::tuple("observer-observer", "olga", console::ROLE_OBSERVER),
        {"operator-operator", "otto", console::ROLE_OPERATOR},
        {"admin-admin-admin", "ada", console::ROLE_ADMIN}}) {
    const auto admitted = access.Admit(token, "192.0.2.1", now);
    REQUIRE(admitted);
    CHECK(admitted->name == name);
    CHECK(admitted->role == role);
    CHECK(access.MayStay(*admitted, now));
  }
  const auto otto = access.Admit("operator-operator", "192.0.2.1", now).value();
  for (const char* none : {"", "operator-operato", "operator-operators"}) {
    CHECK(access.Admit(none, "192.0.2.1", now).error().code == ErrorCode::kRefused);
  }
  SECTION("it ends") { wall_s = 1000.0; }
  SECTION("it is revoked") { REQUIRE(WriteTokens(file, {})); }
  CHECK_FALSE(access.Admit("operator-operator", "192.0.2.1", now));
  CHECK_FALSE(access.MayStay(otto, now + std::chrono::seconds(2)));
}

TEST_CASE("a file of tokens that is missing or malformed stops the start, later it changes nothing",
          "[operator][gateway]") {
  const test::TemporaryFolder folder;
  const auto file = folder / "tokens.json";
  CHECK_THROWS_WITH(AccessControl(file), Catch::Contains("conav token add"));
  for (const char* text :
       {"", "[1]", "{\"tokens\": [{\"name\": \"a\"}]}",
        "{\"tokens\": [{\"name\": \"a\", \"role\": \"king\", \"ends_s\": 1, \"sha256\": \"\"}]}"}) {
    REQUIRE(WriteFile(file, text));
    CHECK_THROWS_AS(AccessControl(file), StartupError);
  }
  AccessControl access(test::TokenFile(file));
  const auto otto = access.Admit("operator-operator", "192.0.2.1", {}).value();
  REQUIRE(WriteFile(file, "{"));
  CHECK(access.MayStay(otto, Clock::TimePoint(std::chrono::hours(1))));
}

// The faults report's S9: "No limit on guessed tokens: 530/s from one client, no delay, no lock-out."
TEST_CASE("an address that guesses tokens has to wait, others and those known there do not",
          "[operator][gateway]") {
  const test::TemporaryFolder folder;
  AccessControl access(test::TokenFile(folder / "tokens.json"));
  Clock::TimePoint now{std::chrono::seconds(100)};
  REQUIRE(access.Admit("observer-observer", "192.0.2.1", now));
  int tried = 0;
  for (int i = 0; i < 2664; ++i) {  // in 5 s, as the report did
    const auto guess = access.Admit(std::to_string(i), "192.0.2.1", now);
    if (guess.error().code == ErrorCode::kRefused) ++tried;
    now += std::chrono::microseconds(1877);
  }
  CHECK(tried <= AccessControl::kWrongAtOnce + 1);
  const auto known = access.Admit("operator-operator", "192.0.2.1", now);
  if (!known) CHECK(known.error().code == ErrorCode::kUnavailable);
  CHECK(access.Admit("observer-observer", "192.0.2.1", now));
  CHECK(access.Admit("operator-operator", "192.0.2.2", now));
  CHECK(access.Admit("operator-operator", "192.0.2.1", now + std::chrono::seconds(6)));
  CHECK_FALSE(access.Admit("", "192.0.2.3", now));  // no guess
  // Nobody's memory grows with the addresses.
  for (std::size_t i = 0; i < 2 * AccessControl::kAddressesRemembered; ++i) {
    CHECK_FALSE(access.Admit("guess", fmt::format("address {}", i), now));
  }
}

TEST_CASE("without tokens everybody is an operator, a token comes as Bearer",
          "[operator][gateway]") {
  AccessControl open("");
  for (const char* token : {"", "left over"}) {
    CHECK(open.Admit(token, "192.0.2.1", {})->role == console::ROLE_OPERATOR);
  }
  CHECK(open.MayStay({}, {}));
  CHECK(BearerToken("Bearer abc") == "abc");
  CHECK(BearerToken("Basic abc").empty());
  CHECK(BearerToken("").empty());
}

TEST_CASE("addresses, localhost and the console's own pages lead here", "[operator][gateway]") {
  const std::string host = GENERATE("127.0.0.1:8080", "127.0.0.1", "localhost:8080", "LocalHost",
                                    "[::1]:8080", "[::1]", "192.168.1.2:80");
  CHECK(WhyForeign({}, host, "").empty());
  CHECK(WhyForeign({}, "127.0.0.1:8080", "http://127.0.0.1:8080").empty());
  CHECK(WhyForeign({}, "[::1]:8080", "http://[::1]:8080").empty());
  GatewayOptions secure;
  secure.tls = {"cert.pem", "key.pem"};
  CHECK(WhyForeign(secure, "127.0.0.1:8080", "https://127.0.0.1:8080").empty());
}

TEST_CASE("other names do not, unless their origin is listed, and no page of another site",
          "[operator][gateway]") {
  GatewayOptions options;
  options.origins = {"https://console.example:8443"};
  for (const char* host : {"evil.example:8080", "", "localhost.evil.example", "::1", "[::1",
                           "127.0.0.1.evil.example"}) {
    CAPTURE(host);
    CHECK_THAT(WhyForeign({}, host, ""), Catch::Contains("operator.console.origins"));
    CHECK_FALSE(WhyForeign(options, host, "").empty());
  }
  CHECK(WhyForeign(options, "console.example:8443", "").empty());
  CHECK(WhyForeign(options, "Console.example", "https://console.example:8443").empty());
  for (const char* origin :
       {"http://evil.example", "null", "http://127.0.0.1:8081", "https://127.0.0.1:8080",
        "http://127.0.0.1", "127.0.0.1:8080", "http://localhost:8080"}) {
    CAPTURE(origin);
    CHECK_THAT(WhyForeign({}, "127.0.0.1:8080", origin), Catch::Contains("origin"));
    CHECK_FALSE(WhyForeign(options, "127.0.0.1:8080", origin).empty());
  }
}

TEST_CASE("a program's own page may connect where that is listed, and leads no name here",
          "[operator][gateway]") {
  GatewayOptions options;
  CHECK_FALSE(WhyForeign(options, "127.0.0.1:8765", "file://").empty());
  options.origins = {"file://"};
  options.origins_key = "operator.foxglove.origins";
  CHECK(CheckAccess(options));
  CHECK(WhyForeign(options, "127.0.0.1:8765", "file://").empty());
  CHECK_THAT(WhyForeign(options, "", "file://"), Catch::Contains("operator.foxglove.origins"));
}

}  // namespace conav::operators
