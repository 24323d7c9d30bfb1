#include "operator/gateway/http_routes.h"

#include <catch2/catch.hpp>
#include <fstream>

#include "common/msg/convert.h"
#include "common/runtime/result.h"
#include "support/temporary_folder.h"
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
    Write(folder / "secret.txt", "secret");
    snapshots.Put("r1", 7, {'j', 'p', 'g'});
  }

  HttpResponse Ask(const HttpRequest& request) const {
    const HttpRoutes routes(options, WebFiles(folder / "page"),
                            {snapshots, [this] { return readiness; }, [] { return "metrics\n"; }});
    return routes.Answer(request);
  }
  HttpResponse Get(const std::string& target) const { return Ask(RequestOf(target)); }

  static HttpRequest RequestOf(const std::string& target) {
    HttpRequest request;
    request.method = "GET";
    request.target = target;
    request.host = "127.0.0.1:8080";
    return request;
  }

  test::TemporaryFolder folder;
  SnapshotStore snapshots{1000};
  Readiness readiness;
  GatewayOptions options;
};

std::string BodyOf(const HttpResponse& response) { return std::string(response.body.bytes); }

std::string Header(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return "";
}

}  // namespace

TEST_CASE("the page and its files are served", "[operator][gateway]") {
  const Bench bench;
  const auto page = bench.Get("/");
  CHECK(page.status == 200);
  CHECK(page.type == "text/html; charset=utf-8");
  CHECK(BodyOf(page) == "<page>");
  CHECK(Header(page, "Cache-Control") == "no-cache");
  CHECK(BodyOf(bench.Get("/index.html?x=1#y")) == "<page>");
  const auto script = bench.Get("/assets/x-123.js");
  CHECK(script.type == "text/javascript; charset=utf-8");
  CHECK_THAT(Header(script, "Cache-Control"), Catch::Contains("immutable"));
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

TEST_CASE("a browser that has the file gets 304", "[operator][gateway]") {
  const Bench bench;
  const std::string etag = Header(bench.Get("/"), "ETag");
  REQUIRE(etag.size() == 18);
  HttpRequest request = Bench::RequestOf("/");
  request.if_none_match = GENERATE_COPY(std::string(etag), "W/" + etag, "\"other\", " + etag,
                                        etag + " ,\"other\"", std::string("*"));
  const auto unchanged = bench.Ask(request);
  CHECK(unchanged.status == 304);
  CHECK(BodyOf(unchanged).empty());
  CHECK(Header(unchanged, "ETag") == etag);
}

TEST_CASE("a browser with another version gets this one", "[operator][gateway]") {
  const Bench bench;
  HttpRequest request = Bench::RequestOf("/");
  request.if_none_match = GENERATE("\"other\"", ",", " , ,", "W/", "0123");
  CHECK(bench.Ask(request).status == 200);
}

TEST_CASE("a service that has stopped to answer is not ready, and then stuck",
          "[operator][gateway]") {
  Bench bench;
  bench.readiness = {true, "{\"ready\":true}", std::chrono::seconds(5)};
  CHECK(bench.Get("/readyz").status == 200);
  CHECK(bench.Get("/livez").status == 200);
  bench.readiness.age = std::chrono::seconds(6);
  CHECK(bench.Get("/readyz").status == 503);
  CHECK_THAT(BodyOf(bench.Get("/readyz")), Catch::Contains("does not answer"));
  CHECK(bench.Get("/livez").status == 200);
  bench.readiness.age = std::chrono::seconds(31);
  CHECK(bench.Get("/livez").status == 503);
}

TEST_CASE("nothing outside the page's folder is served", "[operator][gateway]") {
  const Bench bench;
  const std::string target =
      GENERATE("/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "//secret.txt",
               "/index.html/", "/index.html.gz", "secret.txt", "", "*", "/assets/", "/.",
               "http://127.0.0.1:8080/");
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

TEST_CASE("pictures are served by robot and number", "[operator][gateway]") {
  const Bench bench;
  const auto snapshot = bench.Get("/pictures/r1/7.jpg");
  CHECK(snapshot.status == 200);
  CHECK(snapshot.type == "image/jpeg");
  CHECK(BodyOf(snapshot) == "jpg");
  const std::string unknown =
      GENERATE("/pictures/r1/8.jpg", "/pictures/r2/7.jpg", "/pictures/r1/7.png", "/pictures/r1/7",
               "/pictures/r1/.jpg", "/pictures/r1/-7.jpg", "/pictures/r1/7x.jpg", "/pictures/7.jpg",
               "/pictures/", "/pictures/r1/99999999999999999999.jpg", "/pictures//7.jpg",
               "/pictures/r1/../r1/7.jpg", "/pictures/.jpg", "/pictures//.jpg");
  CHECK(bench.Get(unknown).status == 404);
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
  bench.options.tokens.observer = "observer-observer";
  HttpRequest request = Bench::RequestOf(GENERATE("/metrics", "/pictures/r1/7.jpg"));
  CHECK(bench.Ask(request).status == 401);
  CHECK(Header(bench.Ask(request), "WWW-Authenticate") == "Bearer");
  request.authorization = "Bearer observer-observes";
  CHECK(bench.Ask(request).status == 401);
  request.authorization = "Bearer observer-observer";
  CHECK(bench.Ask(request).status == 200);
  CHECK(bench.Get("/").status == 200);
  CHECK(bench.Get("/livez").status == 200);
  CHECK(bench.Get("/readyz").status == 503);
}

TEST_CASE("the service says whether it is ready", "[operator][gateway]") {
  Bench bench;
  CHECK(BodyOf(bench.Get("/livez")) == "ok\n");
  CHECK(bench.Get("/readyz").status == 503);
  bench.readiness = {true, "{\"ready\":true}"};
  const auto ready = bench.Get("/readyz");
  CHECK(ready.status == 200);
  CHECK(ready.type == "application/json");
  CHECK(BodyOf(ready) == "{\"ready\":true}");
  CHECK(Header(ready, "Cache-Control") == "no-store");
}

TEST_CASE("metrics are served as Prometheus reads them", "[operator][gateway]") {
  const Bench bench;
  const auto metrics = bench.Get("/metrics");
  CHECK(BodyOf(metrics) == "metrics\n");
  CHECK_THAT(metrics.type, Catch::Contains("version=0.0.4"));
}

TEST_CASE("a folder without a page stops the start", "[operator][gateway]") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_AS(WebFiles(folder.path()), StartupError);
  CHECK_THROWS_AS(WebFiles(folder / "nowhere"), StartupError);
  Write(folder / "index.html.gz", "compressed, and nothing else");
  CHECK_THROWS_WITH(WebFiles(folder.path()), Catch::Contains("no index.html"));
}

TEST_CASE("files have types and tags of their own", "[operator][gateway]") {
  const test::TemporaryFolder folder;
  for (const char* name : {"index.html", "a.css", "b.svg", "c.unknown"}) {
    Write(folder / name, name);
  }
  const WebFiles files(folder.path());
  CHECK(files.Find("/a.css")->type == "text/css; charset=utf-8");
  CHECK(files.Find("/b.svg")->type == "image/svg+xml");
  CHECK(files.Find("/c.unknown")->type == "application/octet-stream");
  CHECK(files.Find("/a.css")->etag != files.Find("/b.svg")->etag);
  CHECK(files.Find("/d") == nullptr);
}

}  // namespace conav::operators
