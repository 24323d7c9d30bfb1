#include "planner/perception/embedded_model.h"

#include "common/runtime/result.h"

namespace conav::planner {

EmbeddedPerceptionModel::EmbeddedPerceptionModel(std::shared_ptr<const nhpm::EditModel> model)
    : model_(std::move(model)) {
  DEMAND(model_ != nullptr);
}

}  // namespace conav::planner
