#include <catch2/catch.hpp>
#include <optional>

#include "conformance/perception_model_conformance.h"
#include "nhpm/model/glpf.h"
#include "planner/perception/cached_model.h"
#include "planner/perception/remote_model.h"
#include "support/dds_participant.h"
#include "support/nhpm_on_thread.h"
#include "support/nhpm_process.h"

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

  /// Whoever answers, it must be with the bits of the embedded model.
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

TEST_CASE("A second replica goes on answering when the first goes", "[nhpm]") {
  const auto make = test::InMemory();
  auto first = std::make_unique<test::NhpmOnThread>(make);
  const test::NhpmOnThread second(make);
  PlannerSide planner(make);
  planner.AskUntilAnsweredBy("glpf");
  first.reset();
  for (int i = 0; i < 20; ++i) planner.AskUntilAnsweredBy("glpf");
  CHECK(planner.switches.empty());
}

TEST_CASE("A batch in flight when the service goes is answered", "[nhpm]") {
  const auto make = test::InMemory();
  auto service = std::make_unique<test::NhpmOnThread>(make);
  PlannerSide planner(make);
  planner.AskUntilAnsweredBy("glpf");
  std::atomic<bool> gone{false};
  int wrong = 0;
  std::thread asker([&] {
    while (!gone) wrong += planner.AnswersRight() ? 0 : 1;
  });
  service.reset();
  gone = true;
  asker.join();
  CHECK(wrong == 0);
  planner.AskUntilAnsweredBy("fallback: glpf");
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

}  // namespace
}  // namespace conav::planner
