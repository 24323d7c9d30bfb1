#include "conformance/perception_model_conformance.h"

#include <unistd.h>

#include "planner/perception/embedded_perception_model.h"
#include "planner/perception/fallback_perception_model.h"
#include "planner/perception/remote_perception_model.h"
#include "planner/search/cached_perception_model.h"
#include "planner/search/fake_perception_model.h"
#include "support/nhpm_on_thread.h"

namespace conav::planner {
namespace {

using conformance::CheckPerceptionModelConformance;

/// Participants of a DDS vendor on this machine, in a domain that only this process uses.
test::MakeParticipant OverDds(const std::string& vendor) {
  return [vendor](const std::string& node) {
    bus::ParticipantOptions options;
    options.vendor = vendor;
    options.domain_id = 20 + static_cast<int>(getpid()) % 200;
    options.interface = "lo";
    return std::make_unique<bus::Participant>(node, options);
  };
}

/// A remote model with the service and the participant that it needs.
struct RemoteSetup {
  explicit RemoteSetup(const test::MakeParticipant& make)
      : service(make), participant(make("planner")), model(*participant, Patient()) {}
  static RemotePerceptionModel::Options Patient() {
    return {.model = "glpf", .timeout = std::chrono::seconds(60)};
  }

  test::NhpmOnThread service;
  std::unique_ptr<bus::Participant> participant;
  RemotePerceptionModel model;
};

std::shared_ptr<PerceptionModel> MakeRemote(const test::MakeParticipant& make) {
  const auto setup = std::make_shared<RemoteSetup>(make);
  return {setup, &setup->model};
}

TEST_CASE("The fake model is a perception model", "[conformance]") {
  FakePerceptionModel reference;
  CheckPerceptionModelConformance([] { return std::make_shared<FakePerceptionModel>(); },
                                  reference);
}

TEST_CASE("The embedded GLPF is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return std::make_shared<EmbeddedPerceptionModel>(); },
                                  reference);
}

TEST_CASE("The cached GLPF is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  const auto make = [] {
    return std::make_shared<CachedPerceptionModel>(std::make_shared<EmbeddedPerceptionModel>());
  };
  CheckPerceptionModelConformance(make, reference);
}

TEST_CASE("The service over the in-memory bus is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return MakeRemote(test::InMemory()); }, reference);
}

TEST_CASE("The service over Cyclone DDS is a perception model", "[conformance][dds]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return MakeRemote(OverDds("cyclonedds")); }, reference);
}

TEST_CASE("The service over Fast DDS is a perception model", "[conformance][dds]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return MakeRemote(OverDds("fastdds")); }, reference);
}

TEST_CASE("The cached service is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  const auto make = [] {
    return std::make_shared<CachedPerceptionModel>(MakeRemote(test::InMemory()));
  };
  CheckPerceptionModelConformance(make, reference);
}

/// `primary` backed by the embedded GLPF.
std::shared_ptr<PerceptionModel> WithFallback(std::shared_ptr<PerceptionModel> primary) {
  static const SteadyClock kClock;
  return std::make_shared<FallbackPerceptionModel>(
      std::move(primary), std::make_shared<EmbeddedPerceptionModel>(),
      FallbackPerceptionModel::Options{}, kClock, [](const std::optional<Error>&) {});
}

TEST_CASE("The service with a fallback is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return WithFallback(MakeRemote(test::InMemory())); },
                                  reference);
}

/// A model whose service never came.
class AbsentModel final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery>) override {
    return Fail(ErrorCode::kUnavailable, "absent");
  }
  std::string name() const override { return "absent"; }
};

TEST_CASE("A fallback that is in use is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return WithFallback(std::make_shared<AbsentModel>()); },
                                  reference);
}

}  // namespace
}  // namespace conav::planner
