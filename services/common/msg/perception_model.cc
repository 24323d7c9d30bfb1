#include "common/msg/perception_model.h"

#include <cmath>

namespace conav {

Result<std::vector<double>> PerceptionModel::PredictEdits(const SharedBelief& belief,
                                                          std::span<const ShownView> views) {
  std::vector<PerceptionQuery> queries;
  for (const ShownView& view : views) {
    queries.push_back({*belief, view.path, view.cell, view.heading_rad, view.visible});
  }
  const auto answers = Predict(queries);
  if (!answers) return tl::unexpected(answers.error());
  std::vector<double> edits;
  for (const PerceptionAnswer& answer : *answers) edits.push_back(ExpectedEdits(answer));
  return edits;
}

Result<std::vector<PerceptionAnswer>> FakePerceptionModel::Predict(
    std::span<const PerceptionQuery> queries) {
  std::vector<PerceptionAnswer> answers;
  answers.reserve(queries.size());
  for (const PerceptionQuery& query : queries) {
    if (const auto checked = CheckPerceptionQuery(query); !checked) {
      return tl::unexpected(checked.error());
    }
    answers.push_back(Answer(query));
  }
  return answers;
}

PerceptionAnswer FakePerceptionModel::Answer(const PerceptionQuery& query) const {
  const BeliefGrid& belief = query.belief;
  PerceptionAnswer answer{Grid<float>(belief.rows(), belief.columns()),
                          Grid<float>(belief.rows(), belief.columns())};
  const auto at_distance = [&](Cell cell) {
    const double distance = std::hypot(cell.row - query.cell.row, cell.column - query.cell.column);
    return static_cast<float>(options_.near_probability * std::exp(-options_.decay * distance));
  };
  for (const Cell cell : query.visible.walls) {
    if (!belief.OnBorder(cell)) answer.add[cell] = (1.0F - belief[cell]) * at_distance(cell);
  }
  for (const Cell cell : query.visible.free) {
    if (!belief.OnBorder(cell)) answer.remove[cell] = belief[cell] * at_distance(cell);
  }
  for (const Cell cell : query.path) {
    if (belief.OnBorder(cell)) continue;
    answer.remove[cell] = belief[cell] * static_cast<float>(options_.path_probability);
  }
  return answer;
}

}  // namespace conav
