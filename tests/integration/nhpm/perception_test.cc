#include <atomic>
#include <catch2/catch.hpp>
#include <csignal>
#include <optional>
#include <thread>

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
  explicit PlannerSide(const test::MakeParticipant& make)
      : participant(make("planner")),
        model(std::make_shared<RemotePerceptionModel>(
                  *participant, RemotePerceptionModel::Options{.timeout = seconds(1)}),
              std::make_shared<nhpm::Glpf>(),
              {.first_pause = milliseconds(20), .longest_pause = milliseconds(50)}, clock,
              [](const std::optional<Error>&) {}) {}

  /// Each answer has the bits of the embedded model.
  void AskUntilAnsweredBy(const std::string& name) {
    const auto deadline = std::chrono::steady_clock::now() + seconds(60);
    do {
      REQUIRE(std::chrono::steady_clock::now() < deadline);
      REQUIRE(model.Predict(queries).value() == expected);
    } while (model.identity().name != name);
  }

  SteadyClock clock;
  std::vector<PerceptionQuery> queries = conformance::MakeQueries(8);
  std::vector<PerceptionAnswer> expected = *nhpm::Glpf().Predict(queries);
  std::unique_ptr<bus::Participant> participant;
  FallbackPerceptionModel model;
};

/// SIGKILL leaves the planner no farewell, SIGSTOP not even a dead process: only silence.
TEST_CASE("A killed or stopped conav-nhpm is replaced until it answers again", "[nhpm][dds]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  CAPTURE(vendor);
  test::NhpmProcess service(vendor);
  PlannerSide planner(test::OverDds(vendor));
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

/// `planners`, each with a participant of its own and all the time in the world, ask at the same
/// time; returns how many answers were not those of the GLPF.
int WrongAnswers(const test::MakeParticipant& make, int planners, int requests) {
  const auto queries = conformance::MakeQueries(8);
  const auto expected = *nhpm::Glpf().Predict(queries);
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < planners; ++i) {
    threads.emplace_back([&] {
      const auto participant = make("planner");
      RemotePerceptionModel model(*participant,
                                  {.timeout = seconds(120), .busy_pause = milliseconds(1)});
      for (int n = 0; n < requests; ++n) {
        const auto answers = model.Predict(queries);
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

}  // namespace
}  // namespace conav::planner
