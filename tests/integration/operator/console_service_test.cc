#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <thread>

#include "common/runtime/stop_token.h"
#include "integration/operator/hand_made_sim.h"
#include "integration/operator/page_client.h"
#include "operator/client/operator_client.h"
#include "unit/common/protocol/samples.h"

namespace conav::operators {
namespace {

using Kind = console::Update;

const std::vector<std::string> kMap = {"######", "#    #", "# ## #", "#    #", "######"};

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

/// What one loaded page of the console knows and asks, over all its connections.
class Page {
 public:
  explicit Page(char instance) : instance_(instance) {}

  void Connect(int port) {
    client_.emplace(PageOptions{.port = port});
    REQUIRE(client_->refused() == 0);
    console::ClientMessage message;
    message.mutable_hello()->set_instance(std::string(16, instance_));
    message.mutable_hello()->set_run(welcome.run());
    message.mutable_hello()->set_sequence(sequence_);
    REQUIRE(client_->Send(message));
    ReadUntil([this] { return last_.has_welcome(); });
    welcome = last_.welcome();
  }
  void Disconnect() { client_.reset(); }

  /// The reply to a request with the next id, or with that of the request before.
  console::Reply Ask(console::Request request, bool again = false) {
    console::ClientMessage message;
    request.set_id(again ? id_ : ++id_);
    request.set_world("w1");
    request.set_valid_until(welcome.service_time() + 1000.0);
    *message.mutable_request() = std::move(request);
    REQUIRE(client_->Send(message));
    ReadUntil([this] { return last_.has_reply() && last_.reply().id() == id_; });
    return last_.reply();
  }

  template <class Condition>
  void ReadUntil(const Condition& condition) {
    while (!condition()) Read();
  }
  /// Reads until the belief has that revision.
  void ReadBelief(std::uint64_t revision) {
    ReadUntil([&] { return Has("belief") && at("belief").belief().revision() == revision; });
  }

  bool Has(const std::string& key) const { return known_.contains(key); }
  const console::Update& at(const std::string& key) const { return known_.at(key); }

  console::Welcome welcome;

 private:
  void Read() {
    const auto message = client_->Receive();
    REQUIRE(message);
    last_ = *message;
    if (last_.updates().everything()) known_.clear();
    for (const console::Update& update : last_.updates().update()) {
      sequence_ = update.sequence();
      known_[NameOf(update)] = update;
    }
  }

  static std::string NameOf(const console::Update& update) {
    return update.GetDescriptor()->FindFieldByNumber(update.body_case())->name();
  }

  char instance_;
  std::optional<PageClient> client_;
  console::ServerMessage last_;
  std::map<std::string, console::Update> known_;  // newest of each kind
  std::uint64_t sequence_ = 0;
  std::uint64_t id_ = 0;
};

console::Request EditOf(std::uint64_t base_revision, Cell cell) {
  console::Request request;
  request.mutable_edit()->set_base_revision(base_revision);
  console::CellEdit* edit = request.mutable_edit()->add_cells();
  edit->mutable_cell()->set_row(cell.row);
  edit->mutable_cell()->set_column(cell.column);
  edit->set_wall(true);
  return request;
}

console::Request GuideOf(const std::vector<Cell>& path) {
  console::Request request;
  request.mutable_guide()->set_robot("r1");
  request.mutable_guide()->set_valid_for(60.0);
  for (const Cell cell : path) {
    console::Cell* to = request.mutable_guide()->add_path();
    to->set_row(cell.row);
    to->set_column(cell.column);
  }
  return request;
}

struct Bench {
  Bench() : sim(bus) {
    std::ofstream(folder / "index.html") << "<page>";
    config = ConfigFor(folder / "operator.db");
    config.console.port = 0;
    config.console.web = folder.path().string();
  }

  int Start() {
    service.emplace(bus, config);
    return service->port();
  }

  TemporaryFolder folder;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  HandMadeSim sim;
  OperatorConfig config;
  std::optional<ServiceOnThread> service;
};

std::uint8_t WallAt(const console::Belief& belief, std::size_t index) {
  return static_cast<std::uint8_t>(belief.walls().at(index));
}

}  // namespace

TEST_CASE("a page edits and guides as every client does", "[operator][integration]") {
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
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

TEST_CASE("an edit on an old revision is refused", "[operator][integration]") {
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
  CHECK(page.Ask(EditOf(0, {1, 3})).accepted());
  const auto refused = page.Ask(EditOf(0, {1, 2}));
  CHECK_FALSE(refused.accepted());
  CHECK_THAT(refused.reason(), Catch::Contains("revision"));
  page.ReadBelief(1);
  CHECK(WallAt(page.at("belief").belief(), 8) == 0);
}

TEST_CASE("a request that cannot be is refused with its reason", "[operator][integration]") {
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
  console::Request request = GuideOf({{1, 1}, {1, 2}});
  request.mutable_guide()->set_valid_for(std::nan(""));
  CHECK_THAT(page.Ask(request).reason(), Catch::Contains("valid_for"));
  CHECK_FALSE(page.Ask(EditOf(0, {-1, 0})).accepted());
}

TEST_CASE("a page sees what others did", "[operator][integration]") {
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
  bus::Participant participant("client", bench.bus);
  const SteadyClock clock;
  OperatorClient bert(participant, clock, {"bert", 0.25, 10.0});
  bert.Send("w1", EditRequest{0, {{{1, 3}, true}}}, {});
  page.ReadBelief(1);
  CHECK(page.at("belief").belief().edited_by() == "bert");
  Page other('b');
  other.Connect(bench.service->port());
  other.ReadBelief(1);
  page.ReadUntil([&] { return page.at("presence").presence().people_size() == 2; });
}

TEST_CASE("a restart of the service loses nothing that was accepted", "[operator][integration]") {
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
  const console::Request edit = EditOf(0, {1, 3});
  CHECK(page.Ask(GuideOf({{1, 1}, {1, 2}})).accepted());
  CHECK(page.Ask(edit).accepted());
  const std::string run = page.welcome.run();

  bench.service.reset();
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

TEST_CASE("a page that reconnects in the same run goes on where it was",
          "[operator][integration]") {
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
  page.Disconnect();
  Page other('b');
  other.Connect(bench.service->port());
  other.ReadBelief(0);
  CHECK(other.Ask(EditOf(0, {1, 3})).accepted());
  page.Connect(bench.service->port());
  CHECK(page.welcome.resumed());
  page.ReadBelief(1);
}

TEST_CASE("a simulator that begins anew takes the belief along to its pages",
          "[operator][integration]") {
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({3, 4}, 9'000'000'000);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
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
  Bench bench;
  bench.sim.PublishInitialMap(kMap);
  bench.sim.PublishState({1, 1}, 5);
  Page page('a');
  page.Connect(bench.Start());
  page.ReadBelief(0);
  Picture picture = samples::SamplePicture();
  picture.streamed = false;
  REQUIRE(bench.sim.snapshot.Publish(ToMessage(picture)));
  page.ReadUntil([&] { return page.Has("picture"); });
  CHECK(page.at("picture").picture().bytes() == 3);
  const int port = bench.service->port();
  const auto pixels = Get(port, "/pictures/r1/9.jpg");
  CHECK(pixels.body == "\xFF\xD8\xFF");
  CHECK(Get(port, "/readyz").status == 200);
}

}  // namespace conav::operators
