#include "conformance/perception_model_conformance.h"

#include "planner/perception/embedded_perception_model.h"
#include "planner/perception/fallback_perception_model.h"
#include "planner/perception/remote_perception_model.h"
#include "planner/search/cached_perception_model.h"
#include "planner/search/fake_perception_model.h"
#include "support/dds_participant.h"
#include "support/nhpm_on_thread.h"
#include "support/nhpm_process.h"

namespace conav::planner {
namespace {

using conformance::CheckPerceptionModelConformance;

/// A remote model with the service and the participant that it needs. `Service` is a thread of this
/// process, made from `make`, or a process of its own, made from its vendor.
template <class Service, class ServiceArgument>
std::shared_ptr<PerceptionModel> MakeRemote(const test::MakeParticipant& make,
                                            const ServiceArgument& argument) {
  struct Setup {
    Setup(const test::MakeParticipant& make, const ServiceArgument& argument)
        : service(argument),
          participant(make("planner")),
          model(*participant, {.model = "glpf", .timeout = std::chrono::seconds(60)}) {}
    Service service;
    std::unique_ptr<bus::Participant> participant;
    RemotePerceptionModel model;
  };
  const auto setup = std::make_shared<Setup>(make, argument);
  return {setup, &setup->model};
}

std::shared_ptr<PerceptionModel> MakeThreadRemote(const test::MakeParticipant& make) {
  return MakeRemote<test::NhpmOnThread>(make, make);
}

void CheckProcess(const std::string& planner_vendor, const std::string& nhpm_vendor) {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance(
      [&] { return MakeRemote<test::NhpmProcess>(test::OverDds(planner_vendor), nhpm_vendor); },
      reference);
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
  CheckPerceptionModelConformance([] { return MakeThreadRemote(test::InMemory()); }, reference);
}

TEST_CASE("The service over Cyclone DDS is a perception model", "[conformance][dds]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return MakeThreadRemote(test::OverDds("cyclonedds")); },
                                  reference);
}

TEST_CASE("The service over Fast DDS is a perception model", "[conformance][dds]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return MakeThreadRemote(test::OverDds("fastdds")); },
                                  reference);
}

TEST_CASE("conav-nhpm on Cyclone DDS is a perception model", "[conformance][dds]") {
  CheckProcess("cyclonedds", "cyclonedds");
}

TEST_CASE("conav-nhpm on Fast DDS is a perception model", "[conformance][dds]") {
  CheckProcess("fastdds", "fastdds");
}

TEST_CASE("conav-nhpm on Fast DDS is a perception model for a planner on Cyclone DDS",
          "[conformance][dds]") {
  CheckProcess("cyclonedds", "fastdds");
}

TEST_CASE("conav-nhpm on Cyclone DDS is a perception model for a planner on Fast DDS",
          "[conformance][dds]") {
  CheckProcess("fastdds", "cyclonedds");
}

TEST_CASE("The cached service is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  const auto make = [] {
    return std::make_shared<CachedPerceptionModel>(MakeThreadRemote(test::InMemory()));
  };
  CheckPerceptionModelConformance(make, reference);
}

/// `primary` backed by the embedded GLPF.
std::shared_ptr<PerceptionModel> WithFallback(std::shared_ptr<PerceptionModel> primary) {
  static const SteadyClock clock;
  return std::make_shared<FallbackPerceptionModel>(
      std::move(primary), std::make_shared<EmbeddedPerceptionModel>(),
      FallbackPerceptionModel::Options{}, clock, [](const std::optional<Error>&) {});
}

TEST_CASE("The service with a fallback is a perception model", "[conformance]") {
  EmbeddedPerceptionModel reference;
  CheckPerceptionModelConformance([] { return WithFallback(MakeThreadRemote(test::InMemory())); },
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
