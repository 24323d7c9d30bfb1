#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <optional>
#include <thread>

#include "common/bus/subscriber.h"
#include "conformance/perception_model_conformance.h"
#include "nhpm/model/glpf.h"
#include "nhpm/model/perception_network.h"
#include "planner/perception/cached_model.h"
#include "planner/perception/remote_model.h"
#include "support/dds_participant.h"
#include "support/nhpm_on_thread.h"
#include "support/nhpm_process.h"
#include "support/test_weights.h"

namespace conav::planner {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// A planner's perception as it is used: the service, and behind it the embedded model.
struct PlannerSide {
  explicit PlannerSide(const test::MakeParticipant& make,
                       std::chrono::nanoseconds timeout = seconds(30))
      : participant(make("planner")),
        remote(std::make_shared<RemotePerceptionModel>(
            *participant, RemotePerceptionModel::Options{.timeout = timeout})),
        model(remote, std::make_shared<nhpm::Glpf>(),
              {.first_pause = milliseconds(20), .longest_pause = milliseconds(50)}, clock,
              [this](const std::optional<Error>& why) {
                switches.push_back(why ? why->text : "back");
              }) {}

  /// Each answer has the bits of the embedded model.
  bool AnswersRight() {
    const auto answers = model.Predict(queries);
    return answers && *answers == expected;
  }

  void AskUntilAnsweredBy(const std::string& name) {
    const auto deadline = std::chrono::steady_clock::now() + seconds(60);
    do {
      REQUIRE(std::chrono::steady_clock::now() < deadline);
      REQUIRE(AnswersRight());
    } while (model.identity().name != name);
  }

  SteadyClock clock;
  std::vector<PerceptionQuery> queries = conformance::MakeQueries(8);
  std::vector<PerceptionAnswer> expected = *nhpm::Glpf().Predict(queries);
  std::vector<std::string> switches;
  std::unique_ptr<bus::Participant> participant;
  std::shared_ptr<RemotePerceptionModel> remote;
  FallbackPerceptionModel model;
};

TEST_CASE("When the service goes the fallback answers with equal bits, until it is back",
          "[nhpm][dds]") {
  const std::string bus = GENERATE("memory", "cyclonedds", "fastdds");
  CAPTURE(bus);
  const auto make = bus == "memory" ? test::InMemory() : test::OverDds(bus);
  auto service = std::make_unique<test::NhpmOnThread>(make);
  PlannerSide planner(make);
  planner.AskUntilAnsweredBy("glpf");
  CHECK(planner.switches.empty());

  service.reset();
  planner.AskUntilAnsweredBy("fallback: glpf");
  CHECK(planner.switches.size() == 1);

  service = std::make_unique<test::NhpmOnThread>(make);
  planner.AskUntilAnsweredBy("glpf");
  CHECK(planner.switches.size() == 2);
  CHECK(planner.switches.back() == "back");
}

/// SIGKILL leaves the planner no farewell, SIGSTOP not even a dead process: only silence.
TEST_CASE("A killed or stopped conav-nhpm is replaced until it answers again", "[nhpm][dds]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  CAPTURE(vendor);
  test::NhpmProcess service(vendor);
  PlannerSide planner(test::OverDds(vendor), seconds(1));
  planner.AskUntilAnsweredBy("glpf");
  service.End(SIGKILL);
  planner.AskUntilAnsweredBy("fallback: glpf");
  service.Start();
  planner.AskUntilAnsweredBy("glpf");
  service.Signal(SIGSTOP);
  planner.AskUntilAnsweredBy("fallback: glpf");
  service.Signal(SIGCONT);
  planner.AskUntilAnsweredBy("glpf");
  CHECK(service.End(SIGTERM) == 0);
}

using conformance::MakeQueries;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// A planner process: its own participant, and a remote model that has all the time in the world.
struct Asker {
  explicit Asker(const test::MakeParticipant& make)
      : participant(make("planner")),
        model(*participant, {.timeout = seconds(120), .busy_pause = milliseconds(1)}) {}

  std::unique_ptr<bus::Participant> participant;
  RemotePerceptionModel model;
};

/// `planners` ask at the same time; returns how many answers were not those of the GLPF.
int WrongAnswers(const test::MakeParticipant& make, int planners, int requests) {
  const auto queries = MakeQueries(8);
  const auto expected = *nhpm::Glpf().Predict(queries);
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < planners; ++i) {
    threads.emplace_back([&] {
      Asker asker(make);
      for (int n = 0; n < requests; ++n) {
        const auto answers = asker.model.Predict(queries);
        if (!answers || *answers != expected) ++wrong;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return wrong;
}

TEST_CASE("Many planners are all answered, also when some replies are \"busy\"", "[nhpm]") {
  const auto make = test::InMemory();
  nhpm::NhpmConfig config = test::ServedGlpf();
  config.max_open = 1;
  const auto participant = make(config.name);
  const SteadyClock clock;
  nhpm::NhpmService service(*participant, config, clock);
  std::atomic<bool> done{false};
  std::thread serving([&] {
    while (!done) {
      service.Receive(milliseconds(20));
      if (service.counts().busy > 0) service.AnswerOpen();  // nobody before a reply was "busy"
    }
  });
  const int wrong = WrongAnswers(make, 8, 20);
  done = true;
  serving.join();
  CHECK(wrong == 0);
  CHECK(service.counts().busy > 0);
  CHECK(service.counts().requests >= 160);
}

TEST_CASE("Many planners are answered over both vendors at once", "[nhpm][dds]") {
  const test::NhpmOnThread service(test::OverDds("cyclonedds"));
  const int wrong = WrongAnswers(test::OverDds("fastdds"), 2, 20) +
                    WrongAnswers(test::OverDds("cyclonedds"), 2, 20);
  CHECK(wrong == 0);
}

TEST_CASE("Weights are exchanged while planners ask, and no request is lost", "[nhpm]") {
  const auto make = test::InMemory();
  const test::WeightsFolder folder;
  nhpm::NhpmConfig config;
  config.model = PerceptionModelKind::kNhpm;
  config.weights = folder.Write("default", test::UntrainedNetwork(1));
  const test::NhpmOnThread service(make, config);
  const auto queries = MakeQueries(4);
  const auto before = *nhpm::PerceptionNetwork(test::UntrainedNetwork(1)).Predict(queries);
  const auto after = *nhpm::PerceptionNetwork(test::UntrainedNetwork(2)).Predict(queries);
  const std::string new_checksum = nhpm::ChecksumOf(test::UntrainedNetwork(2));

  Asker asker(make);
  REQUIRE(asker.model.Predict(queries) == before);
  folder.Write("default", test::UntrainedNetwork(2));
  const auto deadline = std::chrono::steady_clock::now() + seconds(60);
  while (asker.model.identity().checksum != new_checksum) {
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    const auto answers = asker.model.Predict(queries);
    REQUIRE(answers);
    REQUIRE(*answers == (asker.model.identity().checksum == new_checksum ? after : before));
  }
  CHECK(asker.model.repeats() == 0);
  CHECK(service.service().counts().refused == 0);
}

/// Until a line of conav-nhpm on /rosout begins with `text`.
void WaitForLine(bus::Participant& participant,
                 bus::Subscriber<rcl_interfaces::msg::Log>& subscriber, const std::string& text) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (true) {
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    participant.Wait(std::chrono::milliseconds(100));
    for (const auto& line : subscriber.Take()) {
      if (line.name() == "nhpm_test" && line.msg().starts_with(text)) return;
    }
  }
}

TEST_CASE("a service writes its log on /rosout, also for who comes late and until its end",
          "[nhpm]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const std::string listener = vendor == "fastdds" ? "cyclonedds" : "fastdds";
  INFO(vendor << " received by " << listener);
  test::NhpmProcess service(vendor);
  const auto participant = test::OverDds(listener)("listener");
  bus::Subscriber<rcl_interfaces::msg::Log> subscriber(*participant, bus::kRosout);
  WaitForLine(*participant, subscriber, "running");
  CHECK(service.End(SIGTERM) == 0);
  WaitForLine(*participant, subscriber, "stopped");
}

}  // namespace
}  // namespace conav::planner
