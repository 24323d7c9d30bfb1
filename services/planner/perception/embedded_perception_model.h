#pragma once

#include "nhpm/model/glpf.h"
#include "planner/search/perception_model.h"

namespace conav::planner {

/// The GLPF inside the planner's own process: asks nobody, never waits.
class EmbeddedPerceptionModel final : public PerceptionModel {
 public:
  explicit EmbeddedPerceptionModel(const nhpm::GlpfParameters& parameters = {})
      : model_(parameters) {}

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override {
    return model_.Predict(queries);
  }
  std::string name() const override { return nhpm::Glpf::name(); }

 private:
  nhpm::Glpf model_;
};

}  // namespace conav::planner
