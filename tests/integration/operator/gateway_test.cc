#include "operator/gateway/gateway.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <thread>

#include "common/runtime/result.h"
#include "integration/operator/gateway_bench.h"
#include "support/wait.h"

namespace conav::operators {
namespace {

using namespace std::chrono_literals;

console::ClientMessage PingAt(double page_time) {
  return MessageOf(fmt::format("ping {{ page_time: {} }}", page_time));
}

/// PEM files of a certificate that nobody else has signed.
ConsoleTls MakeCertificate(const test::TemporaryFolder& folder) {
  const ConsoleTls tls{(folder / "cert.pem").string(), (folder / "key.pem").string()};
  const std::string command =
      "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256"
      " -nodes -days 1 -subj /CN=localhost -keyout " +
      tls.key + " -out " + tls.certificate + " 2>/dev/null";
  REQUIRE(std::system(command.c_str()) == 0);
  return tls;
}

/// A TCP connection that says nothing unless told to.
class RawClient {
 public:
  /// `from`: its own address.
  explicit RawClient(int port, const char* from = "127.0.0.1")
      : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval limit{.tv_sec = 10, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    const sockaddr_in own = Address(from, 0);
    const sockaddr_in service = Address("127.0.0.1", port);
    good_ = ::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof(own)) == 0 &&
            ::connect(socket_, reinterpret_cast<const sockaddr*>(&service), sizeof(service)) == 0;
  }
  ~RawClient() { ::close(socket_); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  bool good() const { return good_; }
  /// Whether a request is answered, by anything.
  bool IsAnswered() {
    std::array<char, 4096> earlier;
    while (::recv(socket_, earlier.data(), earlier.size(), MSG_DONTWAIT) > 0) {
    }
    const std::string request = "GET /livez HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";
    ::send(socket_, request.data(), request.size(), MSG_NOSIGNAL);
    char first = 0;
    return ::recv(socket_, &first, 1, 0) == 1;
  }

 private:
  static sockaddr_in Address(const char* text, int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, text, &address.sin_addr);
    return address;
  }

  int socket_;
  bool good_ = false;
};

/// While it lives, new mute connections come as fast as they can; the newest 300 stay.
class Flood {
 public:
  explicit Flood(int port) : thread_([this, port] { Run(port); }) {}
  ~Flood() {
    ends_ = true;
    thread_.join();
  }

  int connected() const { return connected_; }

 private:
  void Run(int port) {
    std::deque<std::unique_ptr<RawClient>> mute;
    while (!ends_) {
      mute.push_back(std::make_unique<RawClient>(port));
      if (mute.back()->good()) ++connected_;
      if (mute.size() > 300) mute.pop_front();
    }
  }

  std::atomic<bool> ends_ = false;
  std::atomic<int> connected_ = 0;
  std::thread thread_;
};

}  // namespace

TEST_CASE("the service reports pages that connect, ask and leave", "[operator][integration]") {
  GatewayBench bench;
  Gateway& gateway = bench.Start();
  KnowingPage page(bench.Page());
  const PageEvent joined = bench.NextEvent();
  CHECK(std::holds_alternative<PageJoined>(joined.body));
  CHECK(joined.who.client == page.welcome.client());
  REQUIRE(page.client.Send(MessageOf("request { id: 7 stop { reason: 'fire' } }")));
  const PageEvent asked = bench.NextEvent();
  CHECK(std::get<PageAsked>(asked.body).request.stop().reason() == "fire");
  console::Reply reply;
  reply.set_id(7);
  reply.set_accepted(true);
  gateway.Send(asked.page, reply);
  gateway.Send(asked.page + 1, reply);  // nobody's
  page.ReadUntil([&] { return page.last.has_reply(); });
  CHECK(page.last.reply().accepted());
  page.client.Close();
  const PageEvent left = bench.NextEvent();
  CHECK(std::holds_alternative<PageLeft>(left.body));
  CHECK(left.page == joined.page);
  CHECK(bench.Pages() == 0);
  gateway.Send(asked.page, reply);
}

TEST_CASE("pages of other sites, and other paths, are refused", "[operator][integration]") {
  GatewayBench bench;
  bench.Start();
  PageOptions page = bench.Page();
  unsigned status = 403;
  SECTION("a foreign origin") { page.origin = "http://evil.example"; }
  SECTION("a foreign host") { page.host = "evil.example"; }
  SECTION("another path") {
    page.target = std::string("/");
    status = 404;
  }
  CHECK(PageClient(page).refused() == status);
  CHECK(bench.Pages() == 0);
}

TEST_CASE("there are only so many pages, and a place that is left is free",
          "[operator][integration]") {
  GatewayBench bench;
  bench.options.max_pages = 1;
  bench.Start();
  auto first = std::make_unique<KnowingPage>(bench.Page(), HelloOf('a'));
  PageClient second(bench.Page());
  REQUIRE(second.Send(HelloOf('b')));
  const auto refused = second.Receive();
  REQUIRE(refused);
  CHECK(refused->goodbye().retry());
  first->client.Close();
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  for (bool welcome = false; !welcome;) {
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    PageClient third(bench.Page());
    REQUIRE(third.Send(HelloOf('c')));
    const auto answer = third.Receive();
    welcome = answer && answer->has_welcome();
  }
}

TEST_CASE("there are only so many connections, strangers who say nothing keep nobody out",
          "[operator][integration]") {
  GatewayBench narrow;
  narrow.options.max_connections = 1;
  narrow.Start();
  const PageClient stranger(narrow.Page());
  CHECK(stranger.refused() == 0);
  const KnowingPage only(narrow.Page());  // takes the stranger's place, and keeps it
  CHECK(PageClient(narrow.Page()).refused() != 0);
  GatewayBench bench;
  bench.options.max_pages = 1;
  bench.options.max_connections = 40;
  bench.Start();
  std::vector<std::unique_ptr<PageClient>> mute;
  for (int i = 0; i < 20; ++i) mute.push_back(std::make_unique<PageClient>(bench.Page()));
  const KnowingPage page(bench.Page());
  CHECK_FALSE(page.welcome.client().empty());
  const auto goodbye = mute.front()->Receive();
  REQUIRE(goodbye);
  CHECK_THAT(goodbye->goodbye().reason(), Catch::Contains("wait"));
}

// The faults report's S5: "128 mute TCP connections (30 s each, no limit per address, no eviction of
// those without a request) keep all pages out, STOP with them."
TEST_CASE("pages get in, and their STOP with them, while mute connections flood the service",
          "[operator][integration]") {
  GatewayBench bench;
  const int port = bench.Start().port();
  const Flood flood(port);
  REQUIRE(test::WaitUntil([&] { return flood.connected() > 2 * bench.options.max_connections; }));
  std::vector<std::unique_ptr<KnowingPage>> pages;
  for (int i = 0; i < 10; ++i) {
    CHECK(Get(port, "/").status == 200);
    pages.push_back(
        std::make_unique<KnowingPage>(bench.Page(), HelloOf(static_cast<char>('a' + i))));
    REQUIRE(pages.back()->client.Send(MessageOf("request { id: 1 stop { } }")));
    PageEvent event = bench.NextEvent();
    while (!std::holds_alternative<PageAsked>(event.body)) event = bench.NextEvent();
    CHECK(event.who.client == pages.back()->welcome.client());
  }
  for (const auto& page : pages) {  // and none of them was dropped
    REQUIRE(page->client.Send(PingAt(1.0)));
    page->ReadUntil([&] { return page->last.has_pong(); });
  }
}

TEST_CASE("an address has only so many connections, others have theirs",
          "[operator][integration]") {
  GatewayBench bench;
  bench.options.max_connections = 4;
  bench.options.max_connections_per_address = 2;
  const int port = bench.Start().port();
  const KnowingPage first(bench.Page(), HelloOf('a'));
  RawClient idle(port);
  CHECK(idle.IsAnswered());
  const KnowingPage second(bench.Page(), HelloOf('b'));  // takes the place of the idle one
  CHECK_FALSE(idle.IsAnswered());
  CHECK_FALSE(RawClient(port).IsAnswered());  // both places are kept
  RawClient other(port, "127.0.0.2");
  CHECK(other.IsAnswered());  // so it is the older one
  RawClient another(port, "127.0.0.3");
  CHECK(another.IsAnswered());
  RawClient third(port, "127.0.0.4");  // takes the place of the oldest of those that have one each
  CHECK_FALSE(other.IsAnswered());
  CHECK(another.IsAnswered());
  CHECK(third.IsAnswered());
}

TEST_CASE("a forbidden message of a page ends its connection", "[operator][integration]") {
  GatewayBench bench;
  bench.options.max_message_kib = 4;
  bench.Start();
  PageClient page(bench.Page());
  const bool too_large = GENERATE(true, false);
  page.SendBytes(std::string(too_large ? 5000 : 2, '\xFF'));
  if (!too_large) CHECK(page.Receive().value().has_goodbye());
  CHECK_FALSE(page.Receive());
  CHECK(page.close_code() == (too_large ? 1009 : 1008));
  CHECK(page.ended());
}

TEST_CASE("requests that nobody takes are not kept without end", "[operator][integration]") {
  GatewayBench bench;
  bench.Start();
  KnowingPage page(bench.Page());
  console::ClientMessage large;
  large.mutable_request()->mutable_stop()->set_reason(std::string(500'000, 'x'));
  std::uint64_t id = 0;
  while (!page.last.has_goodbye()) {
    REQUIRE(++id < 100);
    large.mutable_request()->set_id(id);
    page.client.Send(large);
    page.client.Send(PingAt(static_cast<double>(id)));
    page.ReadUntil([&] {
      return page.last.has_goodbye() || page.last.pong().page_time() == static_cast<double>(id);
    });
  }
  CHECK(page.last.goodbye().retry());
  CHECK(id == 17);  // 8 MiB
}

TEST_CASE("a page that sends and takes nothing is gone", "[operator][integration]") {
  GatewayBench bench;
  bench.options.idle_s = 1.0;
  bench.options.message_rate = 10000.0;
  bench.Start();
  KnowingPage page(bench.Page());
  CHECK(std::holds_alternative<PageJoined>(bench.NextEvent().body));
  const std::string large(1U << 20U, 'x');
  int round = 0;
  while (bench.events.empty()) {
    REQUIRE(++round < 1000);
    bench.PutUpdate("large", large);
    page.client.Send(PingAt(round));
    bench.TakeEvents();
  }
  CHECK(std::holds_alternative<PageLeft>(bench.events[0].body));
}

TEST_CASE("a connection with TLS is the same", "[operator][integration]") {
  GatewayBench bench;
  bench.options.tls = MakeCertificate(bench.folder);
  Gateway& gateway = bench.Start();
  CHECK_THAT(gateway.url(), Catch::StartsWith("https://127.0.0.1:"));
  PageOptions options = bench.Page();
  CHECK(PageClient(options).refused() != 0);  // without
  options.certificate = bench.options.tls.certificate;
  KnowingPage page(options);
  bench.PutUpdate("b", "1");
  page.ReadUpTo(2);
  CHECK(page.known["b"] == "1");
  page.client.Close();
  CHECK(std::holds_alternative<PageJoined>(bench.NextEvent().body));
  CHECK(std::holds_alternative<PageLeft>(bench.NextEvent().body));
}

TEST_CASE("a page that does not answer to the end of its connection is gone after two seconds",
          "[operator][integration]") {
  GatewayBench bench;
  const bool has_tls = GENERATE(false, true);
  if (has_tls) bench.options.tls = MakeCertificate(bench.folder);
  bench.Start();
  PageOptions options = bench.Page();
  if (has_tls) options.certificate = bench.options.tls.certificate;
  KnowingPage page(options);
  CHECK(std::holds_alternative<PageJoined>(bench.NextEvent().body));
  page.client.SendBytes("\xFF\xFF");
  const auto sent = std::chrono::steady_clock::now();
  CHECK(std::holds_alternative<PageLeft>(bench.NextEvent().body));
  // A second later its stream is destroyed, which AddressSanitizer watches.
  while (std::chrono::steady_clock::now() < sent + std::chrono::seconds(5)) bench.TakeEvents();
  CHECK(KnowingPage(options).client.refused() == 0);
}

TEST_CASE("a certificate, port or address that cannot be used stops the start",
          "[operator][integration]") {
  GatewayBench bench;
  GatewayBench other;
  GatewayOptions& options = bench.options;
  const ConsoleTls tls{(bench.folder / "cert.pem").string(), (bench.folder / "key.pem").string()};
  std::string named;
  SECTION("no file") { options.tls = tls; }
  SECTION("no certificate") {
    options.tls = tls;
    std::ofstream(tls.certificate) << "nothing";
    std::ofstream(tls.key) << "nothing";
  }
  SECTION("another certificate's key") {
    options.tls = MakeCertificate(bench.folder);
    options.tls.key = MakeCertificate(other.folder).key;
  }
  SECTION("a port that is taken") {
    options.port = other.Start().port();
    named = std::to_string(options.port);
  }
  SECTION("strangers without a token") { options.address = "0.0.0.0"; }
  CHECK_THROWS_WITH(bench.Start(), Catch::Contains(named));
  CHECK_THROWS_AS(bench.Start(), StartupError);
}

TEST_CASE("the service that stops says goodbye, and waits for no page", "[operator][integration]") {
  GatewayBench bench;
  bench.Start();
  KnowingPage page(bench.Page(), HelloOf('a'));
  KnowingPage stalled(bench.Page(), HelloOf('b'));
  page.ReadUpTo(1);
  for (int i = 0; i < 20; ++i) {  // more than the connection holds
    bench.PutUpdate("large", std::string(1U << 20U, 'x'));
    page.ReadUpTo(static_cast<std::uint64_t>(i) + 2);
  }
  const PageOptions options = bench.Page();
  const auto began = std::chrono::steady_clock::now();
  bench.gateway.reset();
  CHECK(std::chrono::steady_clock::now() - began < 5s);  // half a second, on a machine at ease
  page.ReadUntil([&] { return page.last.has_goodbye(); });
  CHECK(page.last.goodbye().retry());
  CHECK(PageClient(options).refused() != 0);
}

}  // namespace conav::operators
