#pragma once

#include <memory>

#include "nhpm/model/edit_model.h"
#include "nhpm/model/glpf.h"
#include "planner/search/perception_model.h"

namespace conav::planner {

/// A model inside the planner's own process: asks nobody, never waits. Without one it is the GLPF.
/// Errors: those of nhpm::EditModel.
class EmbeddedPerceptionModel final : public PerceptionModel {
 public:
  explicit EmbeddedPerceptionModel(
      std::shared_ptr<const nhpm::EditModel> model = std::make_shared<const nhpm::Glpf>());

  [[nodiscard]] Result<std::vector<PerceptionAnswer>> Predict(
      std::span<const PerceptionQuery> queries) override {
    return model_->Predict(queries);
  }
  std::string name() const override { return model_->identity().name; }
  std::string identity() const override { return name() + " " + model_->identity().checksum; }

 private:
  std::shared_ptr<const nhpm::EditModel> model_;
};

}  // namespace conav::planner
