#include <atomic>
#include <catch2/catch.hpp>
#include <thread>

#include "conformance/perception_model_conformance.h"
#include "nhpm/model/glpf.h"
#include "nhpm/model/perception_network.h"
#include "planner/perception/remote_model.h"
#include "support/dds_participant.h"
#include "support/nhpm_on_thread.h"
#include "support/test_weights.h"

namespace conav::planner {
namespace {

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

TEST_CASE("Of two replicas one computes a request, once they are known", "[nhpm]") {
  const auto make = test::InMemory();
  const test::NhpmOnThread first(make, test::ServedGlpf("nhpm-1"));
  const test::NhpmOnThread second(make, test::ServedGlpf("nhpm-2"));
  Asker asker(make);
  const auto queries = MakeQueries(2);
  for (int i = 0; i < 50; ++i) REQUIRE(asker.model.Predict(queries));
  const auto computed = first.service().counts().requests + second.service().counts().requests;
  CHECK(asker.model.repeats() == 0);
  CHECK(computed <= 51);  // the first one goes to both
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

}  // namespace
}  // namespace conav::planner
