#include "nhpm/model/load_model.h"
#include "nhpm/model/pooled_model.h"
#include "planner/perception/cached_model.h"
#include "planner/perception/remote_model.h"
#include "planner/planner_service.h"

namespace conav::planner {
namespace {

void ReportSwitch(const std::string& world, const std::string& model,
                  const std::optional<Error>& why) {
  if (why) {
    LOG_WARNING("perception model cannot answer, using the embedded GLPF", "world", world, "model",
                model, "reason", why->text);
  } else {
    LOG_INFO("perception model answers again", "world", world, "model", model);
  }
}

std::shared_ptr<PerceptionModel> MakeEmbedded(const PlannerConfig& config) {
  auto model = nhpm::LoadPerceptionModel(Served(config.perception_model), config.weights, {});
  if (!model) throw StartupError("planner.weights: " + model.error().text);
  const ModelIdentity identity = (*model)->identity();
  LOG_INFO("perception model loaded", "model", identity.name, "version", identity.version,
           "checksum", identity.checksum);
  return *std::move(model);
}

std::shared_ptr<PerceptionModel> MakeRemote(bus::Participant& participant,
                                            const PlannerConfig& config) {
  RemotePerceptionModel::Options options;
  options.model = Name(Served(config.perception_model));
  options.model_checksum = config.perception_checksum;
  options.person = config.person;
  options.timeout = Seconds(config.perception_timeout_s);
  return std::make_shared<RemotePerceptionModel>(participant, options);
}

}  // namespace

PerceptionSetup::PerceptionSetup(bus::Participant& participant, const PlannerConfig& config,
                                 const Clock& clock)
    : clock_(clock),
      needs_fallback_(config.perception == "remote" ||
                      config.perception_model != PerceptionModelKind::kGlpf),
      primary_(config.perception == "remote" ? MakeRemote(participant, config)
                                             : MakeEmbedded(config)),
      cache_bytes_(static_cast<std::size_t>(config.perception_cache_mib * 1024.0 * 1024.0)),
      pools_(config.perception_model == PerceptionModelKind::kAuto),
      glpf_(std::make_shared<nhpm::Glpf>()) {}

std::shared_ptr<PerceptionModel> PerceptionSetup::ForWorld(const std::string& world) const {
  if (!needs_fallback_) return primary_;
  auto model = std::make_shared<FallbackPerceptionModel>(
      std::make_shared<CachedPerceptionModel>(primary_, cache_bytes_), glpf_,
      FallbackPerceptionModel::Options{}, clock_,
      [world, primary = primary_](const std::optional<Error>& why) {
        ReportSwitch(world, primary->identity().name, why);
      });
  if (!pools_) return model;
  return std::make_shared<nhpm::PooledPerceptionModel>(
      std::move(model), std::make_shared<nhpm::Glpf>(nhpm::kGlpfOfTenKinds));
}

PlannerService::PerceptionOfWorld PlannerService::MakePerceptionOfWorld(
    const std::string& world) const {
  auto model = perception_.ForWorld(world);
  if (config_.x_source == "observed") return {std::move(model), nullptr};
  auto estimate = std::make_shared<BeliefEstimate>(model, config_.x_source == "none");
  return {std::move(model), std::move(estimate)};
}

}  // namespace conav::planner
