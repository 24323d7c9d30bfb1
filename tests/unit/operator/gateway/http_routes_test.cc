#include "operator/gateway/http_routes.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "common/msg/convert.h"
#include "common/runtime/result.h"
#include "support/temporary_folder.h"
#include "support/token_file.h"
#include "unit/common/msg/samples.h"

namespace conav::operators {
namespace {

void Write(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

struct Bench {
  Bench() {
    Write(folder / "page/index.html", "<page>");
    Write(folder / "page/index.html.gz", "compressed page");
    Write(folder / "page/assets/x-123.js", "script");
    for (const char* name : {"a.css", "b.svg", "c.unknown"}) Write(folder / "page" / name, name);
    Write(folder / "secret.txt", "secret");
    snapshots.Put("r1", 7, {'j', 'p', 'g'});
  }

  HttpResponse Ask(const HttpRequest& request) const {
    const HttpRoutes routes(
        options, WebFiles(folder / "page"),
        {snapshots, access, [this] { return readiness; }, [] { return "metrics\n"; }});
    return routes.Answer(request);
  }
  HttpResponse Get(const std::string& target) const { return Ask(RequestOf(target)); }

  static HttpRequest RequestOf(const std::string& target) {
    return {.method = "GET", .target = target, .host = "127.0.0.1:8080"};
  }

  test::TemporaryFolder folder;
  SnapshotStore snapshots{1000};
  Readiness readiness;
  GatewayOptions options;
  mutable AccessControl access{""};
};

std::string BodyOf(const HttpResponse& response) { return std::string(response.body.bytes); }

std::string Header(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

}  // namespace

TEST_CASE("what is served has its type, and says how long it may be kept", "[operator][gateway]") {
  Bench bench;
  bench.readiness = {true, "{\"ready\":true}"};
  const auto [target, type, body, kept] =
      GENERATE(table<const char*, const char*, const char*, const char*>({
          {"/", "text/html; charset=utf-8", "<page>", "no-cache"},
          {"/index.html?x=1#y", "text/html; charset=utf-8", "<page>", "no-cache"},
          {"/assets/x-123.js", "text/javascript; charset=utf-8", "script", "immutable"},
          {"/a.css", "text/css; charset=utf-8", "a.css", ""},
          {"/b.svg", "image/svg+xml", "b.svg", ""},
          {"/c.unknown", "application/octet-stream", "c.unknown", ""},
          {"/pictures/r1/7.jpg", "image/jpeg", "jpg", ""},
          {"/livez", "", "ok\n", ""},
          {"/readyz", "application/json", "{\"ready\":true}", "no-store"},
          {"/metrics", "version=0.0.4", "metrics\n", ""},
      }));
  CAPTURE(target);
  const auto answer = bench.Get(target);
  CHECK(answer.status == 200);
  CHECK_THAT(answer.type, Catch::Contains(type));
  CHECK(BodyOf(answer) == body);
  CHECK_THAT(Header(answer, "Cache-Control"), Catch::Contains(kept));
}

TEST_CASE("a browser that accepts gzip gets the compressed form, where there is one",
          "[operator][gateway]") {
  const Bench bench;
  HttpRequest request = Bench::RequestOf("/");
  request.accept_encoding = "gzip, deflate, br";
  const auto page = bench.Ask(request);
  CHECK(BodyOf(page) == "compressed page");
  CHECK(Header(page, "Content-Encoding") == "gzip");
  CHECK(Header(page, "Vary") == "Accept-Encoding");
  CHECK(Header(page, "ETag") != Header(bench.Get("/"), "ETag"));
  request.if_none_match = Header(page, "ETag");
  CHECK(bench.Ask(request).status == 304);
  request.if_none_match.clear();
  request.target = "/assets/x-123.js";
  CHECK(BodyOf(bench.Ask(request)) == "script");
  CHECK(Header(bench.Ask(request), "Content-Encoding").empty());
}

TEST_CASE("a browser that does not accept gzip gets none", "[operator][gateway]") {
  const Bench bench;
  HttpRequest request = Bench::RequestOf("/");
  request.accept_encoding = GENERATE("", "br", "gzip;q=0", "br, gzip ; q=0.000", "x-gzip-like");
  CHECK(BodyOf(bench.Ask(request)) == "<page>");
  request.accept_encoding = GENERATE("gzip;q=0.5", "br;q=1, gzip;q=1.0");
  CHECK(BodyOf(bench.Ask(request)) == "compressed page");
}

TEST_CASE("a browser that has the file gets 304, one with another version this one",
          "[operator][gateway]") {
  const Bench bench;
  const std::string etag = Header(bench.Get("/"), "ETag");
  REQUIRE(etag.size() == 18);
  CHECK(etag != Header(bench.Get("/a.css"), "ETag"));
  HttpRequest request = Bench::RequestOf("/");
  for (const std::string& had :
       {etag, "W/" + etag, "\"other\", " + etag, etag + " ,\"other\"", std::string("*")}) {
    CAPTURE(had);
    request.if_none_match = had;
    const auto unchanged = bench.Ask(request);
    CHECK(unchanged.status == 304);
    CHECK(BodyOf(unchanged).empty());
    CHECK(Header(unchanged, "ETag") == etag);
  }
  request.if_none_match = GENERATE("\"other\"", ",", " , ,", "W/", "0123");
  CHECK(bench.Ask(request).status == 200);
}

TEST_CASE("a service is ready when it says so, not when it stops to answer, and then stuck",
          "[operator][gateway]") {
  Bench bench;
  const auto expect = [&](unsigned ready, unsigned live) {
    CHECK(bench.Get("/readyz").status == ready);
    CHECK(bench.Get("/livez").status == live);
  };
  expect(503, 200);
  bench.readiness = {true, "{\"ready\":true}", std::chrono::seconds(5)};
  expect(200, 200);
  bench.readiness.age = std::chrono::seconds(6);
  expect(503, 200);
  CHECK_THAT(BodyOf(bench.Get("/readyz")), !Catch::Contains("\"ready\":true"));
  bench.readiness.age = std::chrono::seconds(31);
  expect(503, 503);
}

TEST_CASE("nothing outside the page's folder is served, and no picture that is not there",
          "[operator][gateway]") {
  const Bench bench;
  const std::string target = GENERATE(
      "/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "//secret.txt",
      "/index.html/", "/index.html.gz", "secret.txt", "", "*", "/assets/", "/.", "/d",
      "http://127.0.0.1:8080/", "/pictures/r1/8.jpg", "/pictures/r2/7.jpg", "/pictures/r1/7.png",
      "/pictures/r1/7", "/pictures/r1/.jpg", "/pictures/r1/-7.jpg", "/pictures/r1/7x.jpg",
      "/pictures/7.jpg", "/pictures/", "/pictures//7.jpg", "/pictures/r1/99999999999999999999.jpg",
      "/pictures/r1/../r1/7.jpg", "/pictures/.jpg", "/pictures//.jpg");
  CHECK(bench.Get(target).status == 404);
}

TEST_CASE("only GET and HEAD are understood", "[operator][gateway]") {
  const Bench bench;
  HttpRequest request = Bench::RequestOf("/");
  request.method = GENERATE("POST", "PUT", "DELETE", "OPTIONS", "TRACE", "get", "");
  CHECK(bench.Ask(request).status == 405);
  CHECK(Header(bench.Ask(request), "Allow") == "GET, HEAD");
  request.method = "HEAD";
  CHECK(bench.Ask(request).status == 200);
}

TEST_CASE("every answer has the headers that restrict browsers", "[operator][gateway]") {
  const Bench bench;
  const std::string target = GENERATE("/", "/livez", "/nothing", "/pictures/r1/7.jpg");
  const auto answer = bench.Get(target);
  CHECK_THAT(Header(answer, "Content-Security-Policy"), Catch::Contains("default-src 'self'"));
  CHECK_THAT(Header(answer, "Content-Security-Policy"), Catch::Contains("frame-ancestors 'none'"));
  CHECK_THAT(Header(answer, "Content-Security-Policy"), !Catch::Contains("unsafe"));
  CHECK(Header(answer, "X-Content-Type-Options") == "nosniff");
  CHECK(Header(answer, "Referrer-Policy") == "no-referrer");
  CHECK(Header(answer, "Cross-Origin-Resource-Policy") == "same-origin");
  CHECK(Header(HttpRoutes::Refuse(400, "no"), "X-Content-Type-Options") == "nosniff");
}

TEST_CASE("other sites get nothing", "[operator][gateway]") {
  const Bench bench;
  HttpRequest request = Bench::RequestOf(GENERATE("/", "/livez", "/pictures/r1/7.jpg"));
  SECTION("a foreign name") { request.host = "evil.example"; }
  SECTION("a foreign page") { request.origin = "http://evil.example"; }
  CHECK(bench.Ask(request).status == 403);
}

TEST_CASE("a picture's bytes move from the message to the answer", "[operator][gateway]") {
  auto message = ToMessage(samples::SampleSnapshot());
  const void* bytes = message.data().data();
  Snapshot snapshot = kToDomain(std::move(message)).value();
  Bench bench;
  bench.snapshots.Put("r1", 8, std::move(snapshot.jpeg));
  const void* served = bench.Get("/pictures/r1/8.jpg").body.bytes.data();
  CHECK(served == bytes);
}

TEST_CASE("pictures and metrics ask for a token, where there are any", "[operator][gateway]") {
  Bench bench;
  bench.access = AccessControl(test::TokenFile(bench.folder / "tokens.json"));
  HttpRequest request = Bench::RequestOf(GENERATE("/metrics", "/pictures/r1/7.jpg"));
  CHECK(bench.Ask(request).status == 401);
  CHECK(Header(bench.Ask(request), "WWW-Authenticate") == "Bearer");
  request.authorization = "Bearer observer-observes";
  CHECK(bench.Ask(request).status == 401);
  request.authorization = "Bearer observer-observer";
  CHECK(bench.Ask(request).status == 200);
  request.authorization = "Bearer guess";
  for (int i = 0; i < AccessControl::kWrongAtOnce; ++i) bench.Ask(request);
  CHECK(bench.Ask(request).status == 429);
  CHECK(bench.Get("/").status == 200);
  CHECK(bench.Get("/livez").status == 200);
  CHECK(bench.Get("/readyz").status == 503);
}

TEST_CASE("a folder without a page stops the start", "[operator][gateway]") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_AS(WebFiles(folder.path()), StartupError);
  CHECK_THROWS_AS(WebFiles(folder / "nowhere"), StartupError);
  Write(folder / "index.html.gz", "compressed, and nothing else");
  CHECK_THROWS_WITH(WebFiles(folder.path()), Catch::Contains("index.html"));
}

}  // namespace conav::operators
