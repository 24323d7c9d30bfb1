#include "planner/perception/embedded_perception_model.h"

#include "common/runtime/demand.h"

namespace conav::planner {

EmbeddedPerceptionModel::EmbeddedPerceptionModel(std::shared_ptr<const nhpm::EditModel> model)
    : model_(std::move(model)) {
  DEMAND(model_ != nullptr);
}

Result<std::vector<PerceptionAnswer>> EmbeddedPerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  auto answers = model_->Predict(queries);
  if (answers || answers.error().code != ErrorCode::kInvalidArgument) return answers;
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
  }
  return Fail(ErrorCode::kUnavailable, answers.error().text);
}

}  // namespace conav::planner
