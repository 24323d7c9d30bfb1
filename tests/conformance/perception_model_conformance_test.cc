#include "conformance/perception_model_conformance.h"

#include "common/msg/perception_model.h"
#include "nhpm/model/glpf.h"
#include "nhpm/model/load_model.h"
#include "planner/perception/cached_model.h"
#include "planner/perception/remote_model.h"
#include "support/dds_participant.h"
#include "support/nhpm_on_thread.h"
#include "support/nhpm_process.h"
#include "support/test_weights.h"

namespace conav::planner {
namespace {

using conformance::CheckPerceptionModelConformance;

/// A remote model with the service and the participant that it needs. `Service` is a thread of this
/// process, made from `make`, or a process of its own, made from its vendor; both also from what it
/// serves.
template <class Service, class ServiceArgument, class Served>
std::shared_ptr<PerceptionModel> MakeRemote(const test::MakeParticipant& make,
                                            const std::string& model,
                                            const ServiceArgument& argument, const Served& served) {
  struct Setup {
    Setup(const test::MakeParticipant& make, const std::string& model,
          const ServiceArgument& argument, const Served& served)
        : service(argument, served),
          participant(make("planner")),
          model(*participant, {.model = model, .timeout = std::chrono::seconds(60)}) {}
    Service service;
    std::unique_ptr<bus::Participant> participant;
    RemotePerceptionModel model;
  };
  const auto setup = std::make_shared<Setup>(make, model, argument, served);
  return {setup, &setup->model};
}

std::shared_ptr<PerceptionModel> MakeThreadRemote(const test::MakeParticipant& make) {
  return MakeRemote<test::NhpmOnThread>(make, "glpf", make, test::ServedGlpf());
}

void CheckProcess(const std::string& planner_vendor, const std::string& nhpm_vendor) {
  nhpm::Glpf reference;
  CheckPerceptionModelConformance(
      [&] {
        return MakeRemote<test::NhpmProcess>(test::OverDds(planner_vendor), "glpf", nhpm_vendor,
                                             std::string());
      },
      reference);
}

/// A network in a weights file, and the ways to ask it.
struct Network {
  std::shared_ptr<PerceptionModel> Embedded() const {
    return *nhpm::LoadPerceptionModel(PerceptionModelKind::kNhpm, file, {});
  }
  std::shared_ptr<PerceptionModel> OnThread(const test::MakeParticipant& make) const {
    nhpm::NhpmConfig config;
    config.model = "nhpm";
    config.weights = file;
    return MakeRemote<test::NhpmOnThread>(make, "nhpm", make, config);
  }
  std::shared_ptr<PerceptionModel> AsProcess(const std::string& planner_vendor,
                                             const std::string& nhpm_vendor) const {
    return MakeRemote<test::NhpmProcess>(test::OverDds(planner_vendor), "nhpm", nhpm_vendor, file);
  }

  test::WeightsFolder folder;
  std::string file = folder.Write("untrained", test::UntrainedNetwork(5));
  std::shared_ptr<PerceptionModel> reference = Embedded();
};

TEST_CASE("The fake model is a perception model", "[conformance]") {
  FakePerceptionModel reference;
  CheckPerceptionModelConformance([] { return std::make_shared<FakePerceptionModel>(); },
                                  reference);
}

TEST_CASE("The embedded GLPF is a perception model", "[conformance]") {
  nhpm::Glpf reference;
  CheckPerceptionModelConformance([] { return std::make_shared<nhpm::Glpf>(); }, reference);
}

TEST_CASE("The cached GLPF is a perception model", "[conformance]") {
  nhpm::Glpf reference;
  const auto make = [] {
    return std::make_shared<CachedPerceptionModel>(std::make_shared<nhpm::Glpf>());
  };
  CheckPerceptionModelConformance(make, reference);
}

TEST_CASE("The service over the in-memory bus is a perception model", "[conformance]") {
  nhpm::Glpf reference;
  CheckPerceptionModelConformance([] { return MakeThreadRemote(test::InMemory()); }, reference);
}

TEST_CASE("The service over Cyclone DDS is a perception model", "[conformance][dds]") {
  nhpm::Glpf reference;
  CheckPerceptionModelConformance([] { return MakeThreadRemote(test::OverDds("cyclonedds")); },
                                  reference);
}

TEST_CASE("The service over Fast DDS is a perception model", "[conformance][dds]") {
  nhpm::Glpf reference;
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
  nhpm::Glpf reference;
  const auto make = [] {
    return std::make_shared<CachedPerceptionModel>(MakeThreadRemote(test::InMemory()));
  };
  CheckPerceptionModelConformance(make, reference);
}

TEST_CASE("The embedded network is a perception model", "[conformance]") {
  const Network network;
  CheckPerceptionModelConformance([&] { return network.Embedded(); }, *network.reference);
}

TEST_CASE("The cached network is a perception model", "[conformance]") {
  const Network network;
  CheckPerceptionModelConformance(
      [&] { return std::make_shared<CachedPerceptionModel>(network.Embedded()); },
      *network.reference);
}

TEST_CASE("The network served over the in-memory bus is a perception model", "[conformance]") {
  const Network network;
  CheckPerceptionModelConformance([&] { return network.OnThread(test::InMemory()); },
                                  *network.reference);
}

TEST_CASE("The cached service of a network is a perception model", "[conformance]") {
  const Network network;
  CheckPerceptionModelConformance(
      [&] { return std::make_shared<CachedPerceptionModel>(network.OnThread(test::InMemory())); },
      *network.reference);
}

TEST_CASE("A network in conav-nhpm on Cyclone DDS is a perception model", "[conformance][dds]") {
  const Network network;
  CheckPerceptionModelConformance([&] { return network.AsProcess("cyclonedds", "cyclonedds"); },
                                  *network.reference);
}

TEST_CASE("A network in conav-nhpm on Fast DDS is a perception model", "[conformance][dds]") {
  const Network network;
  CheckPerceptionModelConformance([&] { return network.AsProcess("fastdds", "fastdds"); },
                                  *network.reference);
}

TEST_CASE("A network in conav-nhpm on Fast DDS is one for a planner on Cyclone DDS",
          "[conformance][dds]") {
  const Network network;
  CheckPerceptionModelConformance([&] { return network.AsProcess("cyclonedds", "fastdds"); },
                                  *network.reference);
}

/// `primary` backed by the embedded GLPF.
std::shared_ptr<PerceptionModel> WithFallback(std::shared_ptr<PerceptionModel> primary) {
  static const SteadyClock clock;
  return std::make_shared<FallbackPerceptionModel>(
      std::move(primary), std::make_shared<nhpm::Glpf>(), FallbackPerceptionModel::Options{}, clock,
      [](const std::optional<Error>&) {});
}

TEST_CASE("The service with a fallback is a perception model", "[conformance]") {
  nhpm::Glpf reference;
  CheckPerceptionModelConformance([] { return WithFallback(MakeThreadRemote(test::InMemory())); },
                                  reference);
}

/// A model whose service never came.
class AbsentModel final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery>) override {
    return Fail(ErrorCode::kUnavailable, "absent");
  }
  ModelIdentity identity() const override { return {"absent", "", ""}; }
};

TEST_CASE("A fallback that is in use is a perception model", "[conformance]") {
  nhpm::Glpf reference;
  CheckPerceptionModelConformance([] { return WithFallback(std::make_shared<AbsentModel>()); },
                                  reference);
}

}  // namespace
}  // namespace conav::planner
