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
using Model = std::shared_ptr<PerceptionModel>;

/// A remote model with the service and the participant that it needs. `Service` is a thread of this
/// process, made from `make`, or a process of its own, made from its vendor; both also from what it
/// serves.
template <class Service, class ServiceArgument, class Served>
Model MakeRemote(const test::MakeParticipant& make, const std::string& model,
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

/// The GLPF or, from a weights file, a network, and the ways to ask it.
class Asked {
 public:
  explicit Asked(PerceptionModelKind kind) : kind_(kind) {}

  Model Embedded() const { return *nhpm::LoadPerceptionModel(kind_, file(), {}); }
  Model OnThread(const test::MakeParticipant& make) const {
    nhpm::NhpmConfig config = test::ServedGlpf();
    config.model = kind_;
    config.weights = file();
    return MakeRemote<test::NhpmOnThread>(make, name(), make, config);
  }
  Model AsProcess(const std::string& planner_vendor, const std::string& nhpm_vendor) const {
    return MakeRemote<test::NhpmProcess>(test::OverDds(planner_vendor), name(), nhpm_vendor,
                                         nhpm::NhpmConfig{.model = kind_, .weights = file()});
  }
  static Model Cached(const Model& model) { return std::make_shared<CachedPerceptionModel>(model); }

 private:
  std::string name() const { return std::string(Name(kind_)); }
  std::string file() const {
    if (kind_ == PerceptionModelKind::kGlpf) return "";
    return kind_ == PerceptionModelKind::kNhpm ? mazes_ : rasters_;
  }

  PerceptionModelKind kind_;
  test::WeightsFolder folder_;
  std::string mazes_ = folder_.Write("mazes", test::UntrainedNetwork(5));
  std::string rasters_ = folder_.Write("rasters", test::UntrainedEncoderDecoder(5));
};

void Check(const Asked& asked, const std::function<Model()>& make) {
  CheckPerceptionModelConformance(make, *asked.Embedded());
}

/// `primary` backed by the embedded GLPF.
Model WithFallback(Model primary) {
  static const SteadyClock clock;
  return std::make_shared<FallbackPerceptionModel>(
      std::move(primary), std::make_shared<nhpm::Glpf>(), FallbackPerceptionModel::Options{}, clock,
      [](const std::optional<Error>&) {});
}

/// A model whose service never came.
class AbsentModel final : public PerceptionModel {
 public:
  Result<std::vector<PerceptionAnswer>> Predict(std::span<const PerceptionQuery>) override {
    return Fail(ErrorCode::kUnavailable, "absent");
  }
  ModelIdentity identity() const override { return {"absent", "", ""}; }
};

TEST_CASE("The fake model is a perception model", "[conformance]") {
  FakePerceptionModel reference;
  CheckPerceptionModelConformance([] { return std::make_shared<FakePerceptionModel>(); },
                                  reference);
}

TEST_CASE("A model in this process is a perception model, also behind a cache", "[conformance]") {
  const Asked asked(GENERATE(from_range(kPerceptionModels)));
  const bool cached = GENERATE(false, true);
  CAPTURE(cached);
  Check(asked, [&] { return cached ? Asked::Cached(asked.Embedded()) : asked.Embedded(); });
}

TEST_CASE("The service over the in-memory bus is a perception model, also behind a cache",
          "[conformance]") {
  const Asked asked(GENERATE(from_range(kPerceptionModels)));
  const bool cached = GENERATE(false, true);
  CAPTURE(cached);
  Check(asked, [&] {
    const Model remote = asked.OnThread(test::InMemory());
    return cached ? Asked::Cached(remote) : remote;
  });
}

TEST_CASE("conav-nhpm is a perception model, whichever vendors it and the planner use",
          "[conformance][dds]") {
  const Asked asked(GENERATE(from_range(kPerceptionModels)));
  const std::string planner = GENERATE("cyclonedds", "fastdds");
  const std::string nhpm = GENERATE("cyclonedds", "fastdds");
  CAPTURE(planner, nhpm);
  Check(asked, [&] { return asked.AsProcess(planner, nhpm); });
}

TEST_CASE("The service with a fallback is a perception model, also while the fallback is in use",
          "[conformance]") {
  const Asked asked(PerceptionModelKind::kGlpf);
  const bool absent = GENERATE(false, true);
  CAPTURE(absent);
  Check(asked, [&] {
    return WithFallback(absent ? std::make_shared<AbsentModel>()
                               : asked.OnThread(test::InMemory()));
  });
}

}  // namespace
}  // namespace conav::planner
