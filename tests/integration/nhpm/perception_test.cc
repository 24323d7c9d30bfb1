#include <catch2/catch.hpp>
#include <csignal>

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

TEST_CASE("Weights are exchanged while a planner asks, and no request is lost", "[nhpm]") {
  const auto make = test::InMemory();
  const test::WeightsFolder folder;
  nhpm::NhpmConfig config;
  config.model = PerceptionModelKind::kNhpm;
  config.weights = folder.Write("default", test::UntrainedNetwork(1));
  const test::NhpmOnThread service(make, config);
  const auto queries = conformance::MakeQueries(4);
  const auto before = *nhpm::PerceptionNetwork(test::UntrainedNetwork(1)).Predict(queries);
  const auto after = *nhpm::PerceptionNetwork(test::UntrainedNetwork(2)).Predict(queries);
  const std::string new_checksum = nhpm::ChecksumOf(test::UntrainedNetwork(2));
  const auto participant = make("planner");
  RemotePerceptionModel model(*participant, {.timeout = seconds(120)});
  REQUIRE(model.Predict(queries) == before);
  folder.Write("default", test::UntrainedNetwork(2));
  const auto deadline = std::chrono::steady_clock::now() + seconds(60);
  while (model.identity().checksum != new_checksum) {
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    const auto answers = model.Predict(queries);
    REQUIRE(answers);
    REQUIRE(*answers == (model.identity().checksum == new_checksum ? after : before));
  }
  CHECK(model.repeats() == 0);
}

}  // namespace
}  // namespace conav::planner
