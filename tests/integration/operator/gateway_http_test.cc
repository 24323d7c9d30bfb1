#include <catch2/catch.hpp>

#include "integration/operator/gateway_bench.h"

namespace conav::operators {
namespace {

std::string Request(const std::string& line, const std::string& headers = "") {
  return line + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" + headers + "\r\n";
}

}  // namespace

TEST_CASE("one connection answers one request after the other", "[operator][integration]") {
  GatewayBench bench;
  bench.snapshots.Put("r1", 7, {'j', 'p', 'g'});
  bench.Start();
  const auto answers =
      AskRaw(bench.gateway->port(),
             Request("GET /") + Request("GET /pictures/r1/7.jpg") + Request("GET /nothing") +
                 Request("GET /livez", "Connection: close\r\n") + Request("GET /"),
             5);
  REQUIRE(answers.size() == 4);
  CHECK(answers[0].body == "<page>");
  CHECK(answers[1].body == "jpg");
  CHECK(answers[1].headers.at("Content-Type") == "image/jpeg");
  CHECK(answers[2].status == 404);
  CHECK(answers[3].body == "ok\n");
  CHECK(answers[3].headers.at("Connection") == "close");
}

TEST_CASE(
    "HEAD and a page that the browser has are answered without a body, the connection goes on",
    "[operator][integration]") {
  GatewayBench bench;
  bench.Start();
  const auto heads =
      AskRaw(bench.gateway->port(), Request("HEAD /") + Request("HEAD /livez"), 2, true);
  REQUIRE(heads.size() == 2);
  CHECK(heads[0].status == 200);
  CHECK(heads[0].headers.at("Content-Length") == "6");
  CHECK(heads[1].headers.at("Content-Length") == "3");
  const int port = bench.gateway->port();
  const std::string etag = Get(port, "/").headers.at("ETag");
  const auto answers =
      AskRaw(port, Request("GET /", "If-None-Match: " + etag + "\r\n") + Request("GET /livez"), 2);
  REQUIRE(answers.size() == 2);
  CHECK(answers[0].status == 304);
  CHECK(answers[0].body.empty());
  CHECK(answers[1].body == "ok\n");
}

TEST_CASE("malformed requests, and those with a body, are refused", "[operator][integration]") {
  GatewayBench bench;
  bench.Start();
  const int port = bench.gateway->port();
  const auto status_of = [&](const std::string& bytes) {
    const auto answers = AskRaw(port, bytes, 2);
    CHECK(answers.size() <= 1);  // and the connection is closed
    return answers.empty() ? 0 : answers[0].status;
  };
  CHECK(status_of("no request\r\n\r\n") == 400);
  CHECK(status_of(Request("GET /", "X: " + std::string(20'000, 'x') + "\r\n")) == 431);
  CHECK(status_of(Request("POST /", "Content-Length: 5\r\n") + "12345") == 413);
  CHECK(status_of(Request("GET /", "Transfer-Encoding: chunked\r\n") + "0\r\n\r\n") == 413);
  CHECK(Get(port, "/livez", "Content-Length: 0\r\n").status == 200);
}

TEST_CASE("the gateway says whether it is ready, and counts", "[operator][integration]") {
  GatewayBench bench;
  Gateway& gateway = bench.Start();
  CHECK(Get(gateway.port(), "/readyz").status == 503);
  gateway.SetReadiness({true, "{\"ready\":true}"});
  CHECK(Get(gateway.port(), "/readyz").body == "{\"ready\":true}");
  CHECK(MetricOf(gateway.port(), "conav_console_http_requests_total{status=\"503\"}") == 1.0);
  CHECK(bench.Pages() == 0.0);
  const auto shown = static_cast<double>(bench.updates.bytes());
  CHECK(shown > 0.0);
  CHECK(MetricOf(gateway.port(), "conav_console_shown_bytes") == shown);
}

TEST_CASE("a gateway on IPv6 says its address as browsers need it", "[operator][integration]") {
  GatewayBench bench;
  bench.options.address = "::1";
  try {
    bench.Start();
  } catch (const std::exception& error) {
    WARN("no IPv6 here: " << error.what());
    return;
  }
  CHECK(bench.gateway->url() == "http://[::1]:" + std::to_string(bench.gateway->port()));
}

}  // namespace conav::operators
