#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/runtime/result.h"
#include "nhpm/evaluation/evaluation.h"
#include "nhpm/evaluation/metrics.h"

namespace conav::nhpm {
namespace {

struct Corner {
  std::vector<double> position;
  double value = 0.0;
};

/// The corners of the simplex, best first.
class Simplex {
 public:
  using Function = std::function<double(std::span<const double>)>;

  Simplex(const Function& function, std::span<const double> start, double step)
      : function_(function) {
    corners_.push_back(At({start.begin(), start.end()}));
    for (std::size_t i = 0; i < start.size(); ++i) {
      std::vector<double> position(start.begin(), start.end());
      position[i] += step;
      corners_.push_back(At(std::move(position)));
    }
    Sort();
  }

  const Corner& best() const { return corners_.front(); }

  bool Converged(double tolerance) const {
    if (!(corners_.back().value - best().value < tolerance)) return false;
    const double reach = std::sqrt(tolerance);
    return std::ranges::all_of(corners_, [&](const Corner& corner) {
      return std::ranges::equal(corner.position, best().position,
                                [&](double a, double b) { return std::abs(a - b) < reach; });
    });
  }

  void Step() {
    Corner& worst = corners_.back();
    const Corner reflected = Along(-1.0);
    if (reflected.value < best().value) {
      const Corner expanded = Along(-2.0);
      worst = expanded.value < reflected.value ? expanded : reflected;
    } else if (reflected.value < corners_[corners_.size() - 2].value) {
      worst = reflected;
    } else {
      const bool outside = reflected.value < worst.value;
      const Corner contracted = Along(outside ? -0.5 : 0.5);
      if (contracted.value < std::min(reflected.value, worst.value)) {
        worst = contracted;
      } else {
        Shrink();
      }
    }
    Sort();
  }

 private:
  Corner At(std::vector<double> position) const {
    const double value = function_(position);
    return {std::move(position),
            std::isnan(value) ? std::numeric_limits<double>::infinity() : value};
  }

  /// A point on the line from the centroid of all other corners (0) to the worst one (1).
  Corner Along(double share) const {
    const std::vector<double>& worst = corners_.back().position;
    std::vector<double> position(worst.size(), 0.0);
    for (std::size_t i = 0; i < worst.size(); ++i) {
      for (std::size_t corner = 0; corner + 1 < corners_.size(); ++corner) {
        position[i] += corners_[corner].position[i] / static_cast<double>(corners_.size() - 1);
      }
      position[i] += share * (worst[i] - position[i]);
    }
    return At(std::move(position));
  }

  void Shrink() {
    for (std::size_t corner = 1; corner < corners_.size(); ++corner) {
      std::vector<double> position = corners_[corner].position;
      for (std::size_t i = 0; i < position.size(); ++i) {
        position[i] = 0.5 * (position[i] + best().position[i]);
      }
      corners_[corner] = At(std::move(position));
    }
  }

  void Sort() {
    std::stable_sort(corners_.begin(), corners_.end(),
                     [](const Corner& a, const Corner& b) { return a.value < b.value; });
  }

  const Function& function_;
  std::vector<Corner> corners_;
};

int SquaredDistance(Cell a, Cell b) {
  const Cell offset = a - b;
  return offset.row * offset.row + offset.column * offset.column;
}

void CountSegment(const Segment& segment, GlpfStatistics& statistics) {
  const PerceptionQuery& query = segment.query;
  const std::set<Cell> walls(query.visible.walls.begin(), query.visible.walls.end());
  const std::set<Cell> free(query.visible.free.begin(), query.visible.free.end());
  const std::set<Cell> path(query.path.begin(), query.path.end());
  const BeliefGrid& before = query.belief;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const Cell cell = before.CellAt(i);
    if (before.OnBorder(cell)) continue;
    const bool is_wall = before.values()[i] >= 0.5F;
    const bool seen_wrong = is_wall ? free.contains(cell) : walls.contains(cell);
    const int distance = SquaredDistance(cell, query.cell);
    StimulusCount& count = seen_wrong                       ? statistics.seen[distance]
                           : is_wall && path.contains(cell) ? statistics.on_path[distance]
                                                            : statistics.unstimulated;
    count.outputs += 1.0;
    count.edits += is_wall != (segment.belief_after.values()[i] >= 0.5F) ? 1.0 : 0.0;
  }
}

double LossOf(const StimulusCount& count, double probability) {
  return count.edits * CrossEntropy(probability, true) +
         (count.outputs - count.edits) * CrossEntropy(probability, false);
}

constexpr double kLargestAlpha = 10.0;
constexpr double kLargestBeta = 1000.0;
constexpr double kLargestRate = 0.5;

/// The search is unconstrained: over logarithms of the positive parameters, and angles for the
/// rates, which reach both ends of their range.
enum Coordinate : std::size_t { kAlphaD, kBeta, kRho, kLambda, kAlphaM, kCoordinates };

double FromLogarithm(double value, double largest) {
  return std::clamp(std::exp(value), 1.0e-9, largest);
}

double RateFromAngle(double angle) {
  const double sine = std::sin(angle);
  return kLargestRate * sine * sine;
}

double AngleFromRate(double rate) { return std::asin(std::sqrt(rate / kLargestRate)); }

GlpfParameters ParametersAt(std::span<const double> position, GlpfParameters form) {
  form.alpha_d = FromLogarithm(position[kAlphaD], kLargestAlpha);
  form.beta = FromLogarithm(position[kBeta], kLargestBeta);
  form.rho = RateFromAngle(position[kRho]);
  form.lambda = RateFromAngle(position[kLambda]);
  form.alpha_m = FromLogarithm(position[kAlphaM], kLargestAlpha);
  return form;
}

std::vector<double> PositionOf(const GlpfParameters& parameters) {
  std::vector<double> position(kCoordinates);
  position[kAlphaD] = std::log(parameters.alpha_d);
  position[kBeta] = std::log(parameters.beta);
  position[kRho] = AngleFromRate(parameters.rho);
  position[kLambda] = AngleFromRate(parameters.lambda);
  position[kAlphaM] = std::log(parameters.alpha_m);
  return position;
}

std::vector<GlpfParameters> Starts(const GlpfParameters& form) {
  std::vector<GlpfParameters> starts;
  for (const double alpha_d : {0.03, 0.1, 0.3, 1.0}) {
    for (const double alpha_m : {0.2, 0.7}) {
      for (const double beta : {4.0, 20.0}) {
        GlpfParameters start = form;
        start.alpha_d = alpha_d;
        start.alpha_m = alpha_m;
        start.beta = beta;
        start.rho = 0.003;
        start.lambda = 0.1;
        starts.push_back(start);
      }
    }
  }
  return starts;
}

GlpfVariant FitForm(const GlpfStatistics& statistics, const GlpfParameters& form) {
  const auto loss = [&](std::span<const double> position) {
    return GlpfLoss(statistics, ParametersAt(position, form));
  };
  GlpfVariant best{form, std::numeric_limits<double>::infinity()};
  const auto improve_from = [&](const GlpfParameters& start) {
    const NelderMeadResult found =
        MinimiseNelderMead(loss, PositionOf(start), {.tolerance = 1.0e-13});
    if (found.value < best.loss) best = {ParametersAt(found.position, form), found.value};
  };
  for (const GlpfParameters& start : Starts(form)) improve_from(start);
  improve_from(best.parameters);  // a fresh simplex escapes where the first one collapsed
  return best;
}

}  // namespace

NelderMeadResult MinimiseNelderMead(const std::function<double(std::span<const double>)>& function,
                                    std::span<const double> start,
                                    const NelderMeadOptions& options) {
  DEMAND(!start.empty());
  Simplex simplex(function, start, options.first_step);
  NelderMeadResult result;
  while (result.iterations < options.iterations && !result.converged) {
    simplex.Step();
    ++result.iterations;
    result.converged = simplex.Converged(options.tolerance);
  }
  result.position = simplex.best().position;
  result.value = simplex.best().value;
  return result;
}

double GlpfStatistics::outputs() const {
  double sum = unstimulated.outputs;
  for (const auto& [distance, count] : seen) sum += count.outputs;
  for (const auto& [distance, count] : on_path) sum += count.outputs;
  return sum;
}

namespace {

void AddStatistics(const StimulusCount& from, double factor, StimulusCount& to) {
  to.outputs += factor * from.outputs;
  to.edits += factor * from.edits;
}

}  // namespace

GlpfStatistics WeightedSum(const GlpfStatistics& a, double factor, const GlpfStatistics& b) {
  GlpfStatistics sum = b;
  for (const auto& [distance, count] : a.seen) AddStatistics(count, factor, sum.seen[distance]);
  for (const auto& [distance, count] : a.on_path) {
    AddStatistics(count, factor, sum.on_path[distance]);
  }
  AddStatistics(a.unstimulated, factor, sum.unstimulated);
  return sum;
}

GlpfStatistics CountStimuli(std::span<const Segment* const> segments) {
  GlpfStatistics statistics;
  for (const Segment* segment : segments) CountSegment(*segment, statistics);
  return statistics;
}

double GlpfLoss(const GlpfStatistics& statistics, const GlpfParameters& parameters) {
  const double outputs = statistics.outputs();
  if (outputs == 0.0) return 0.0;
  Glpf model(parameters);
  const auto response_at = [&](int squared_distance) {
    return model.Response(model.Stimulus(std::sqrt(static_cast<double>(squared_distance))));
  };
  double sum = LossOf(statistics.unstimulated, model.Response(0.0));
  for (const auto& [distance, count] : statistics.seen) sum += LossOf(count, response_at(distance));
  for (const auto& [distance, count] : statistics.on_path) {
    sum += LossOf(count, parameters.visible_only ? model.Response(0.0) : response_at(distance));
  }
  return sum / outputs;
}

GlpfFit FitGlpf(const GlpfStatistics& statistics) {
  GlpfFit fit;
  for (const bool visible_only : {false, true}) {
    GlpfParameters form;
    form.visible_only = visible_only;
    fit.variants.push_back(FitForm(statistics, form));
  }
  fit.best =
      *std::min_element(fit.variants.begin(), fit.variants.end(),
                        [](const GlpfVariant& a, const GlpfVariant& b) { return a.loss < b.loss; });
  return fit;
}

}  // namespace conav::nhpm
