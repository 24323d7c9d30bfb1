#include <catch2/catch.hpp>
#include <thread>

#include "common/runtime/threads.h"
#include "integration/operator/console_bench.h"
#include "unit/common/msg/samples.h"

namespace conav::operators {
namespace {

/// The real service with its console, on a thread of its own.
class ServiceOnThread {
 public:
  ServiceOnThread(const std::shared_ptr<bus::InMemoryBus>& bus, const OperatorConfig& config)
      : participant_("operator", bus),
        service_(participant_, config, clock_),
        thread_([this] { service_.Run(stop_); }) {}
  ~ServiceOnThread() {
    stop_.RequestStop();
    participant_.Wake();
    thread_.join();
  }
  ServiceOnThread(const ServiceOnThread&) = delete;
  ServiceOnThread& operator=(const ServiceOnThread&) = delete;

  int port() const {
    const std::string url = service_.console_url();
    return std::stoi(url.substr(url.rfind(':') + 1));
  }

 private:
  SteadyClock clock_;
  StopToken stop_;
  bus::Participant participant_;
  OperatorService service_;
  std::thread thread_;
};

/// Such a service with a served world, and a page that has its map.
struct ServedBench : ConsoleFolder {
  explicit ServedBench(Cell robot = {1, 1}, std::int64_t stamp_ns = 5) {
    sim.PublishInitialMap(kMap);
    sim.PublishState(robot, stamp_ns);
    page.Connect(Start());
    page.ReadBelief(0);
  }

  int Start() {
    service.reset();
    service.emplace(bus, config);
    return service->port();
  }

  std::optional<ServiceOnThread> service;
  Page page{'a'};
};

std::uint8_t WallAt(const console::Belief& belief, std::size_t index) {
  return static_cast<std::uint8_t>(belief.walls().at(index));
}

}  // namespace

TEST_CASE("a page edits and guides as every client does", "[operator][integration]") {
  ServedBench bench;
  Page& page = bench.page;
  page.ReadUntil([&] { return page.Has("robot"); });
  CHECK(page.at("robot").robot().cell().column() == 1);

  const auto edited = page.Ask(EditOf(0, {1, 3}));
  CHECK(edited.accepted());
  CHECK(edited.revision() == 1);
  page.ReadBelief(1);
  const auto belief = page.at("belief").belief();
  CHECK(WallAt(belief, 9) == 255);
  CHECK(static_cast<std::uint8_t>(belief.initial_walls()[9]) == 0);
  CHECK(belief.edited_by() == page.welcome.client());
  CHECK(bench.sim.NewestBelief().revision == 1);

  CHECK(page.Ask(GuideOf({{1, 1}, {1, 2}})).accepted());
  page.ReadUntil([&] { return page.Has("guidance"); });
  CHECK(page.at("guidance").guidance().given_by() == page.welcome.client());
  CHECK(bench.sim.NewestGuidance().path == std::vector<Cell>{{1, 1}, {1, 2}});
}

TEST_CASE("a restart of the service loses nothing that was accepted", "[operator][integration]") {
  ServedBench bench;
  Page& page = bench.page;
  const console::Request edit = EditOf(0, {1, 3});
  CHECK(page.Ask(GuideOf({{1, 1}, {1, 2}})).accepted());
  CHECK(page.Ask(edit).accepted());
  const std::string run = page.welcome.run();

  page.Connect(bench.Start());

  CHECK(page.welcome.run() != run);
  CHECK_FALSE(page.welcome.resumed());
  page.ReadBelief(1);
  CHECK(WallAt(page.at("belief").belief(), 9) == 255);
  page.ReadUntil([&] { return page.Has("guidance"); });
  CHECK(page.at("guidance").guidance().path_size() == 2);
  const auto again = page.Ask(edit, true);  // its reply might have been lost
  CHECK(again.accepted());
  CHECK(again.revision() == 1);
}

TEST_CASE("the belief outlives a restart of the simulator, also on its pages",
          "[operator][integration]") {
  ServedBench bench({3, 4}, 9'000'000'000);
  Page& page = bench.page;
  page.ReadUntil([&] { return page.Has("robot"); });
  CHECK(page.Ask(EditOf(0, {1, 3})).accepted());
  bench.sim.PublishInitialMap(kMap);  // first, as every simulator does
  bench.sim.PublishState({1, 1}, 1'000'000'000);
  const std::string run = page.welcome.run();
  do {
    page.Connect(bench.service->port());
  } while (page.welcome.run() == run);
  page.ReadBelief(1);
  page.ReadUntil([&] { return page.Has("world") && page.Has("robot"); });
  CHECK(page.at("world").world().rows() == 5);
  CHECK(page.at("robot").robot().stamp() == 1.0);
}

TEST_CASE("a picture of a robot is on the page, with its pixels", "[operator][integration]") {
  ServedBench bench;
  Page& page = bench.page;
  Snapshot snapshot = samples::SampleSnapshot();
  snapshot.streamed = false;
  REQUIRE(bench.sim.snapshot.Publish(ToMessage(snapshot)));
  page.ReadUntil([&] { return page.Has("picture"); });
  CHECK(page.at("picture").snapshot().bytes() == 3);
  const int port = bench.service->port();
  const auto pixels = Get(port, "/pictures/r1/9.jpg");
  CHECK(pixels.body == "\xFF\xD8\xFF");
  CHECK(Get(port, "/readyz").status == 200);
}

}  // namespace conav::operators
