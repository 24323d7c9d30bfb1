#include "planner/decision/no_news_model.h"

namespace conav::planner {

Result<std::vector<PerceptionAnswer>> NoNewsModel::Predict(
    std::span<const PerceptionQuery> queries) {
  std::vector<PerceptionAnswer> answers;
  for (const PerceptionQuery& query : queries) {
    const Grid<float> nothing(query.belief.rows(), query.belief.columns(), 0.0F);
    answers.push_back({nothing, nothing});
  }
  return answers;
}

}  // namespace conav::planner
