#include "operator/gateway/page_feed.h"

#include <limits>

#include "support/temporary_folder.h"
#include "support/token_file.h"
#include "unit/operator/gateway/page_bench.h"

namespace conav::operators {
namespace {

using std::chrono::milliseconds;

/// Her name, and what SHA-256 makes of the newline and instance that PageBench says.
constexpr const char* kAnna = "anna/871c40f90aad17b5";

/// "a=1 b=2!" with "!" for everything.
std::string Text(const console::ServerMessage& message) {
  std::string text;
  for (const auto& update : message.updates().update()) {
    if (!text.empty()) text += ' ';
    text += update.service().name() + '=' + update.service().message();
  }
  return text + (message.updates().everything() ? "!" : "");
}

}  // namespace

TEST_CASE("a page that says hello is welcome and gets everything", "[operator][gateway]") {
  PageBench bench;
  const auto events = bench.Send(PageBench::Hello());
  REQUIRE(events.size() == 1);
  CHECK(events[0].page == 1);
  CHECK(events[0].who.client == kAnna);
  CHECK(events[0].who.name == "anna");
  CHECK(std::holds_alternative<PageJoined>(events[0].body));
  const auto welcome = bench.NextOne().welcome();
  CHECK(welcome.client() == kAnna);
  CHECK(welcome.role() == console::ROLE_OPERATOR);
  CHECK(welcome.limits().edit_cells() == 100);
  CHECK(welcome.service_time() == 1000.0);
  CHECK_FALSE(welcome.resumed());
  CHECK(Text(bench.NextOne()) == "a=1!");
  CHECK_FALSE(bench.Next());
  CHECK(bench.feed->fault().empty());
}

TEST_CASE("a page's name does not reveal its key", "[operator][gateway]") {
  PageBench bench;
  const std::string name = bench.Join().client();
  bench.Connect();
  CHECK(bench.Join().client() == name);  // the same page comes back
  console::Hello other = PageBench::Hello();
  other.set_instance(name.substr(name.find('/') + 1));
  bench.Connect();
  CHECK(bench.Join(other).client() != name);
}

TEST_CASE("a page too many, or one that says too much, gets the reason and may come back",
          "[operator][gateway]") {
  PageBench full;
  full.has_room = false;
  CHECK(full.Send(PageBench::Hello()).empty());
  CHECK_FALSE(full.feed->has_joined());
  full.ExpectGoodbye("operator.console.max_pages", true);
  PageBench bench;
  bench.options.message_rate = 1.0;
  bench.options.message_burst = 3;
  bench.Connect();
  bench.Join();
  bench.Ping(1.0);
  bench.Ping(2.0);
  CHECK_FALSE(bench.Drain().back().has_goodbye());
  bench.Ping(3.0);
  bench.ExpectGoodbye("too many", true);
  CHECK(bench.Ping(4.0).empty());
  CHECK_FALSE(bench.Next());
}

TEST_CASE("nothing is said before Hello, which has to come within a while", "[operator][gateway]") {
  PageBench bench;
  bench.PutFrame("r1");
  CHECK_FALSE(bench.Next());
  CHECK(bench.feed->due() == bench.clock.Now() + PageFeed::kHelloLimit);
  bench.clock.Advance(PageFeed::kHelloLimit - milliseconds(1));
  CHECK_FALSE(bench.Next());
  bench.clock.Advance(milliseconds(1));
  bench.ExpectGoodbye("no Hello", true);
  PageBench polite;
  polite.Join();
  polite.clock.Advance(2 * PageFeed::kHelloLimit);
  CHECK_FALSE(polite.Next());
  CHECK_FALSE(polite.feed->finished());
}

TEST_CASE("a page is closed for good that begins wrong, or says what is no message",
          "[operator][gateway]") {
  PageBench bench;
  SECTION("no Hello") {
    CHECK(bench.Ping(1.0).empty());
    bench.ExpectGoodbye("first message", false);
  }
  SECTION("two of them") {
    bench.Join();
    CHECK(bench.Send(PageBench::Hello()).empty());
    bench.ExpectGoodbye("second Hello", false);
  }
  SECTION("no message") {
    bench.Join();
    console::ClientMessage no_utf8;
    no_utf8.mutable_hello()->set_name("\xFF");
    const std::string bytes = GENERATE_COPY(std::string(), std::string("\xFF\xFF"),
                                            std::string(99, 'x'), no_utf8.SerializeAsString());
    CHECK(bench.feed->Take(bytes, bench.clock.Now(), 0.0).empty());
    bench.ExpectGoodbye("ClientMessage", false);
  }
}

TEST_CASE("a wrong hello is refused", "[operator][gateway]") {
  // name, instance, what is wrong
  const auto [name, instance, wrong] = GENERATE(table<std::string, std::string, std::string>({
      {"anna", "", "instance"},
      {"anna", "0123456789abcde", "instance"},
      {"anna", std::string(65, 'a'), "instance"},
      {"anna", "0123456789ABCDEF", "instance"},
      {std::string(41, 'a'), "0123456789abcdef", "name"},
      {"an\nna", "0123456789abcdef", "name"},
      {"an/na", "0123456789abcdef", "name"},
  }));
  PageBench bench;
  console::Hello hello = PageBench::Hello();
  hello.set_name(name);
  hello.set_instance(instance);
  CHECK(bench.Send(hello).empty());
  bench.ExpectGoodbye(wrong, false);
  CHECK_FALSE(bench.feed->identity());
  CHECK_FALSE(bench.feed->fault().empty());
}

TEST_CASE("names keep their letters, clients have those of the bus", "[operator][gateway]") {
  std::string long_name;  // 40 letters of two bytes
  for (int i = 0; i < 40; ++i) long_name += "\xC3\xAB";
  for (const auto& [name, letters] : {std::pair(std::string(), std::string("console")),
                                      {"Zo\xC3\xAB B.", "Zo___B_"},
                                      {long_name, std::string(40, '_')}}) {
    CAPTURE(name);
    PageBench bench;
    console::Hello hello = PageBench::Hello();
    hello.set_name(name);
    CHECK(bench.Join(hello).client() == letters + "/871c40f90aad17b5");
    if (!name.empty()) CHECK(bench.feed->identity()->name == name);
  }
}

TEST_CASE("tokens give roles and names, where there are any", "[operator][gateway]") {
  const test::TemporaryFolder folder;
  PageBench bench;
  bench.access = AccessControl(test::TokenFile(folder / "tokens.json"));
  console::Hello hello = PageBench::Hello();
  hello.set_token("observer-observer");
  const console::Welcome welcome = bench.Join(hello);
  CHECK(welcome.role() == console::ROLE_OBSERVER);
  CHECK_THAT(welcome.client(), Catch::StartsWith("olga/"));
  CHECK(bench.feed->identity()->name == "olga");  // whatever the page says
  for (const auto& [token, reason] :
       {std::pair("", "a token is required"), std::pair("observer-observes", "not known")}) {
    bench.Connect();
    hello.set_token(token);
    CHECK(bench.Send(hello).empty());
    bench.ExpectGoodbye(reason, false);
  }
}

TEST_CASE(
    "the experimenter's role is for studies that have one, and for admins where there are tokens",
    "[operator][gateway]") {
  const test::TemporaryFolder folder;
  PageBench bench;
  console::Hello hello = PageBench::Hello();
  hello.set_experimenter(true);
  bench.Send(hello);
  bench.ExpectGoodbye("no experimenter", false);
  bench.welcome.set_experimenter(true);
  bench.Connect();
  CHECK(bench.Join(hello).role() == console::ROLE_EXPERIMENTER);
  bench.access = AccessControl(test::TokenFile(folder / "tokens.json"));
  bench.Connect();
  hello.set_token("operator-operator");
  bench.Send(hello);
  bench.ExpectGoodbye("token of an admin", false);
  bench.Connect();
  hello.set_token("admin-admin-admin");
  CHECK(bench.Join(hello).role() == console::ROLE_EXPERIMENTER);
}

// The faults report's S10: "One token per role: nobody can be told apart, no end, no change without
// restart".
TEST_CASE("a page whose token is revoked is closed within a second or two", "[operator][gateway]") {
  const test::TemporaryFolder folder;
  PageBench bench;
  bench.access = AccessControl(test::TokenFile(folder / "tokens.json"));
  console::Hello hello = PageBench::Hello();
  hello.set_token("operator-operator");
  bench.Join(hello);
  REQUIRE(WriteTokens(folder / "tokens.json", {}));
  bench.clock.Advance(std::chrono::seconds(2));
  const bool asks = GENERATE(true, false);
  if (asks) CHECK(bench.Send("request { id: 1 resume { } }").empty());
  bench.ExpectGoodbye("revoked", false);
}

TEST_CASE("a page that comes back gets what changed since, once", "[operator][gateway]") {
  PageBench bench;
  bench.updates.Put("b", Said("b", "1"));
  console::Hello hello = PageBench::Hello();
  hello.set_run(bench.Join().run());
  hello.set_sequence(2);
  bench.updates.Put("a", Said("a", "2"));
  CHECK(bench.Return(hello).resumed());
  CHECK(Text(bench.NextOne()) == "a=2");
  CHECK_FALSE(bench.Next());
}

TEST_CASE("a page that cannot go on starts again", "[operator][gateway]") {
  PageBench bench;
  console::Hello hello = PageBench::Hello();
  hello.set_run(bench.Join().run());
  hello.set_sequence(1);
  SECTION("another run of the service") { hello.set_run("before.1"); }
  SECTION("no run") { hello.clear_run(); }
  SECTION("a sequence number of the future") { hello.set_sequence(99); }
  SECTION("it lost the connection between Welcome and the first updates") { hello.set_sequence(0); }
  SECTION("a world has restarted") {
    bench.updates.Forget([](std::string_view) { return false; });
  }
  CHECK_FALSE(bench.Return(hello).resumed());
  CHECK(Text(bench.NextOne()) == "a=1!");
}

TEST_CASE("when a world restarts, pages come back for everything", "[operator][gateway]") {
  PageBench bench;
  const std::string run = bench.Join().run();
  bench.updates.Clear();
  bench.PutDue("b", "1");
  bench.ExpectGoodbye("new run", true);
  CHECK(bench.feed->fault().empty());  // of the page, it is none
  console::Hello hello = PageBench::Hello();
  hello.set_run(run);
  hello.set_sequence(2);
  const auto welcome = bench.Return(hello);
  CHECK_FALSE(welcome.resumed());
  CHECK(welcome.run() != run);
  CHECK(Text(bench.NextOne()) == "b=1!");
}

TEST_CASE("a page of a replay that goes back stays and gets everything", "[operator][gateway]") {
  PageBench bench;
  bench.welcome.set_mode(console::MODE_REPLAY);
  bench.Join();
  bench.updates.Clear();
  bench.PutDue("b", "1");
  CHECK(Text(bench.NextOne()) == "b=1!");
  bench.PutDue("c", "1");
  CHECK(Text(bench.NextOne()) == "c=1");
  CHECK_FALSE(bench.feed->finished());
}

TEST_CASE("a large beginning comes in messages that are small", "[operator][gateway]") {
  PageBench bench;
  const std::string large(PageFeed::kBatchBytes / 2, 'x');
  for (const char* key : {"b", "c", "d"}) bench.updates.Put(key, Said(key, large));
  bench.Send(PageBench::Hello());
  bench.NextOne();
  const auto messages = bench.Drain();
  REQUIRE(messages.size() == 3);
  CHECK(messages[0].updates().everything());
  CHECK_FALSE(messages[1].updates().everything());
  CHECK_FALSE(messages[2].updates().everything());
  std::uint64_t sequence = 0;
  for (const auto& message : messages) {
    for (const auto& update : message.updates().update()) CHECK(update.sequence() == ++sequence);
  }
  CHECK(sequence == 4);
}

TEST_CASE("updates come so often and no oftener", "[operator][gateway]") {
  PageBench bench;
  bench.options.update_rate_hz = 10.0;
  bench.Join();
  bench.updates.Put("a", Said("a", "2"));
  CHECK_FALSE(bench.Next());
  CHECK(bench.feed->due() == bench.clock.Now() + milliseconds(100));
  bench.clock.Advance(milliseconds(100));
  bench.updates.Put("a", Said("a", "3"));
  CHECK(Text(bench.NextOne()) == "a=3");
  bench.clock.Advance(milliseconds(100));
  CHECK_FALSE(bench.Next());
  CHECK_FALSE(bench.feed->due());
}

TEST_CASE("pings are answered at once, those of a page that is used and seeks are handed over",
          "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  CHECK(bench.Ping(12.5).empty());
  const auto pong = bench.NextOne().pong();
  CHECK(pong.page_time() == 12.5);
  CHECK(pong.service_time() == 1000.0);
  const auto events = bench.Ping(1.0, 0.0, true);
  REQUIRE(events.size() == 1);
  CHECK(std::holds_alternative<PageUsed>(events[0].body));
  const auto sought = bench.Send("seek { position: 3.5 }");
  REQUIRE(sought.size() == 1);
  CHECK(std::get<console::Seek>(sought[0].body).position() == 3.5);
}

TEST_CASE("a page asks, is answered, and learns why it is closed", "[operator][gateway]") {
  PageBench bench;
  bench.Join();
  SECTION("a request is handed over with the round trip") {
    const double measured = GENERATE(0.25, -3.0, std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::infinity());
    bench.Ping(1.0, measured);
    const auto events = bench.Send("request { id: 7 }");
    REQUIRE(events.size() == 1);
    const auto& asked = std::get<PageAsked>(events[0].body);
    CHECK(asked.request.id() == 7);
    CHECK(asked.round_trip_s == (measured == 0.25 ? 0.25 : 0.0));
    CHECK(events[0].who.client == kAnna);
  }
  SECTION("answers go before updates") {
    bench.PutDue("a", "2");
    console::Reply reply;
    reply.set_id(7);
    bench.feed->Add(reply);
    CHECK(bench.NextOne().reply().id() == 7);
    CHECK(Text(bench.NextOne()) == "a=2");
  }
  SECTION("a page that takes no answers is closed") {
    for (std::size_t i = 0; i < PageFeed::kQueueLimit; ++i) bench.feed->Add(console::Reply());
    CHECK_FALSE(bench.feed->retry());
    bench.feed->Add(console::Reply());
    const auto messages = bench.Drain();
    CHECK(messages.size() == PageFeed::kQueueLimit + 1);
    CHECK(messages.back().has_goodbye());
    CHECK(bench.feed->finished());
    bench.feed->Add(console::Reply());
    CHECK_FALSE(bench.Next());
  }
  SECTION("a page that is closed learns why and nothing else") {
    bench.feed->Close("enough", false);
    bench.feed->Close("again", true);
    bench.PutDue("a", "2");
    CHECK_FALSE(bench.feed->finished());
    CHECK(bench.Drain().size() == 1);
    CHECK(bench.feed->finished());
    CHECK(bench.feed->fault() == "enough");
    CHECK(bench.Ping(1.0).empty());
  }
  SECTION("the service ends a page without blaming it") {
    bench.feed->End("the service stops");
    bench.ExpectGoodbye("stops", true);
    CHECK(bench.feed->fault().empty());
  }
}

}  // namespace conav::operators
