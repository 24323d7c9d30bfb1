#include "operator/gateway/access.h"

#include <catch2/catch.hpp>
#include <functional>

namespace conav::operators {
namespace {

const ConsoleTokens kTokens{"observer-observer", "operator-operator", "admin-admin-admin"};

std::string CheckAllowed(const GatewayOptions& options) {
  const auto checked = CheckAccess(options);
  return checked ? "" : checked.error().text;
}

}  // namespace

TEST_CASE("an address that others reach needs tokens, loopback needs none", "[operator][gateway]") {
  GatewayOptions options;
  CHECK(CheckAllowed(options).empty());
  options.address = GENERATE("127.0.0.1", "127.9.9.9", "::1");
  CHECK(CheckAllowed(options).empty());
  options.address = GENERATE("0.0.0.0", "192.168.1.2", "::", "fe80::1");
  CHECK_THAT(CheckAllowed(options), Catch::Contains("operator.console.tokens"));
  options.tokens.observer = "observer-observer";
  CHECK(CheckAllowed(options).empty());
}

TEST_CASE("options that cannot work are refused by their name", "[operator][gateway]") {
  using Options = GatewayOptions;
  const std::vector<std::pair<std::function<void(Options&)>, const char*>> rows{
      {[](Options& o) { o.address = "localhost"; }, "operator.console.address"},
      {[](Options& o) { o.tls.certificate = "cert.pem"; }, "operator.console.tls"},
      {[](Options& o) { o.tls.key = "key.pem"; }, "operator.console.tls"},
      {[](Options& o) { o.tokens.admin = "fifteen-letters"; }, "operator.console.tokens.admin"},
      {[](Options& o) {
         o.tokens = {"sixteen-letters-", "operator-operator", "sixteen-letters-"};
       },
       "observer and admin"}};
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

TEST_CASE("each token gives its role and comes as Bearer, without tokens everybody is an operator",
          "[operator][gateway]") {
  const ConsoleTokens no_admin{"observer-observer", "", ""};  // such a role is nobody's
  using Role = std::optional<console::Role>;
  CHECK(RoleOf(kTokens, "observer-observer") == Role(console::ROLE_OBSERVER));
  CHECK(RoleOf(kTokens, "operator-operator") == Role(console::ROLE_OPERATOR));
  CHECK(RoleOf(kTokens, "admin-admin-admin") == Role(console::ROLE_ADMIN));
  for (const char* none : {"", "observer-observe", "observer-observers"}) {
    CHECK(RoleOf(kTokens, none) == std::nullopt);
  }
  CHECK(RoleOf(no_admin, "") == std::nullopt);
  CHECK(RoleOf({}, "") == Role(console::ROLE_OPERATOR));
  CHECK(RoleOf({}, "left over") == Role(console::ROLE_OPERATOR));
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
