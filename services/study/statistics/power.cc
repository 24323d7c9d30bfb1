#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/distributions/non_central_t.hpp>
#include <cmath>
#include <map>
#include <numeric>

#include "common/runtime/random.h"
#include "study/statistics/analysis.h"

namespace conav::statistics {
namespace {

constexpr int kPlanDraws = 2000;
constexpr std::uint64_t kPlanSeed = 1;
/// Perugini, Gallucci and Costantini, 2014: plan for the lower end of the effect's 60 % interval.
constexpr double kCautious = 0.8;  // one-sided
/// A noncentrality that no critical value reaches.
constexpr double kCertain = 100.0;

/// P(T <= t) of noncentral t.
double NoncentralBelow(double t, double df, double noncentrality) {
  return boost::math::cdf(boost::math::non_central_t(df, noncentrality), t);
}

/// The d_z below which the true one lies with probability 1 - kCautious; empty if that is not above 0.
std::optional<double> CautiousEffect(double d_z, int subjects) {
  const double root = std::sqrt(subjects);
  const double t = std::abs(d_z) * root;
  if (!std::isfinite(t) || t > kCertain) return std::abs(d_z);
  double low = 0.0;
  double high = t;
  if (NoncentralBelow(t, subjects - 1.0, low) < kCautious) return std::nullopt;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (NoncentralBelow(t, subjects - 1.0, middle) > kCautious ? low : high) = middle;
  }
  return low / root;
}

/// Draws studies like the pilot and tests each of them as the report does.
class StudySimulation {
 public:
  /// `resampled`: subjects are drawn from those of the pilot; else from the normal distribution with
  /// its means and covariance.
  StudySimulation(const ConditionTable& pilot, bool resampled, double alpha)
      : pilot_(pilot), resampled_(resampled), alpha_(alpha), k_(pilot.condition_count()) {
    const auto rows = static_cast<Eigen::Index>(pilot.subject_count());
    const auto columns = static_cast<Eigen::Index>(k_);
    Eigen::MatrixXd values(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < columns; ++j) {
        values(i, j) = pilot.At(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
      }
    }
    mean_ = values.colwise().mean();
    const Eigen::MatrixXd centred = values.rowwise() - mean_.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centred.transpose() * centred /
                                                                static_cast<double>(rows - 1));
    root_ = solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  }

  /// Shares of kPlanDraws studies of so many subjects: in which Holm's test shows each pair, in
  /// ComparePairs' order; last, in which the ANOVA shows a difference.
  const std::vector<double>& PowersWith(int subjects) {
    const auto [known, is_new] = powers_.emplace(subjects, std::vector<double>());
    if (!is_new) return known->second;
    const std::size_t pairs = k_ * (k_ - 1) / 2;
    std::vector<double> limits;  // of |t|, for the largest first
    for (std::size_t i = 0; i < pairs; ++i) {
      limits.push_back(
          StudentQuantile(1.0 - alpha_ / (2.0 * static_cast<double>(pairs - i)), subjects - 1.0));
    }
    std::vector<int> shown(pairs + 1, 0);
    Random random(kPlanSeed);
    for (int draw = 0; draw < kPlanDraws; ++draw) {
      DrawStudy(random, subjects);
      CountPairs(subjects, limits, shown);
      if (ShowsAnova(subjects)) ++shown.back();
    }
    for (const int count : shown) {
      known->second.push_back(static_cast<double>(count) / kPlanDraws);
    }
    return known->second;
  }

 private:
  void DrawSubject(Random& random, Eigen::VectorXd& values) {
    if (resampled_) {
      const auto row = random.Uniform(0, static_cast<std::int64_t>(pilot_.subject_count()) - 1);
      for (std::size_t j = 0; j < k_; ++j) {
        values[static_cast<Eigen::Index>(j)] = pilot_.At(static_cast<std::size_t>(row), j);
      }
      return;
    }
    for (Eigen::Index j = 0; j < values.size(); ++j) normal_[j] = DrawNormal(random);
    values.noalias() = mean_ + root_ * normal_;
  }

  /// Sets the means and the covariance of one study.
  void DrawStudy(Random& random, int subjects) {
    const auto k = static_cast<Eigen::Index>(k_);
    Eigen::VectorXd values(k);
    normal_.resize(k);
    drawn_mean_.setZero(k);
    covariance_.setZero(k, k);
    for (int i = 0; i < subjects; ++i) {
      DrawSubject(random, values);
      values -= mean_;  // keeps the sums of squares small
      drawn_mean_ += values;
      covariance_.noalias() += values * values.transpose();
    }
    const double n = subjects;
    drawn_mean_ /= n;
    covariance_ = (covariance_ - n * drawn_mean_ * drawn_mean_.transpose()) / (n - 1.0);
    drawn_mean_ += mean_;
  }

  /// Holm, 1979: from the largest |t| on, until one is not above its limit.
  void CountPairs(int subjects, const std::vector<double>& limits, std::vector<int>& shown) const {
    std::vector<std::pair<double, std::size_t>> ts;
    for (Eigen::Index a = 0; a < covariance_.rows(); ++a) {
      for (Eigen::Index b = a + 1; b < covariance_.rows(); ++b) {
        const double difference = std::abs(drawn_mean_[a] - drawn_mean_[b]);
        const double variance = covariance_(a, a) + covariance_(b, b) - 2.0 * covariance_(a, b);
        const double error = std::sqrt(std::max(0.0, variance) / subjects);
        const double rounding = RoundingError(Magnitude(pilot_));
        const double t = error > rounding        ? difference / error
                         : difference > rounding ? HUGE_VAL
                                                 : 0.0;
        ts.emplace_back(t, ts.size());
      }
    }
    std::ranges::sort(ts, std::greater());
    for (std::size_t i = 0; i < ts.size() && ts[i].first > limits[i]; ++i) ++shown[ts[i].second];
  }

  /// F of the ANOVA, with Greenhouse and Geisser's degrees of freedom.
  bool ShowsAnova(int subjects) const {
    const double p = static_cast<double>(k_) - 1.0;
    const Eigen::MatrixXd rows = covariance_.rowwise() - covariance_.colwise().mean();
    const Eigen::MatrixXd centred = rows.colwise() - rows.rowwise().mean();
    const double trace = centred.trace();
    const double between = (drawn_mean_.array() - drawn_mean_.mean()).matrix().squaredNorm();
    if (trace <= std::pow(RoundingError(Magnitude(pilot_)), 2)) return between > 0.0;
    const double epsilon = std::clamp(trace * trace / (p * centred.squaredNorm()), 1.0 / p, 1.0);
    return FisherUpper(subjects * between / trace, epsilon * p, epsilon * p * (subjects - 1.0)) <
           alpha_;
  }

  const ConditionTable& pilot_;
  const bool resampled_;
  const double alpha_;
  const std::size_t k_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd root_;  // its product with its transpose is the pilot's covariance
  Eigen::VectorXd normal_;
  Eigen::VectorXd drawn_mean_;
  Eigen::MatrixXd covariance_;
  std::map<int, std::vector<double>> powers_;
};

SubjectsNeeded Needed(const std::function<double(int)>& power_with) {
  const auto fewest = [&](double power) {
    return FewestSubjects([&](int subjects) { return power_with(subjects) >= power; });
  };
  return {fewest(kPower), fewest(kHighPower)};
}

SubjectsNeeded Simulated(StudySimulation& simulation, std::size_t test) {
  return Needed([&](int subjects) { return simulation.PowersWith(subjects)[test]; });
}

SubjectsNeeded ByFormula(const std::optional<double>& d_z, double alpha) {
  if (!d_z) return {};
  return Needed([&](int subjects) { return PairedTPower(*d_z, subjects, alpha); });
}

}  // namespace

std::optional<int> FewestSubjects(const std::function<bool(int)>& is_enough) {
  int few = 1;
  int enough = 2;
  while (!is_enough(enough)) {
    if (enough == kMostSubjectsForPower) return std::nullopt;
    few = enough;
    enough = std::min(2 * enough, kMostSubjectsForPower);
  }
  while (enough - few > 1) {
    const int middle = (few + enough) / 2;
    (is_enough(middle) ? enough : few) = middle;
  }
  return enough;
}

double PairedTPower(double d_z, int subjects, double alpha) {
  const double noncentrality = std::abs(d_z) * std::sqrt(subjects);
  if (!(noncentrality < kCertain)) return 1.0;
  const double df = subjects - 1.0;
  const double limit = StudentQuantile(1.0 - alpha / 2.0, df);
  return 1.0 - NoncentralBelow(limit, df, noncentrality) +
         NoncentralBelow(-limit, df, noncentrality);
}

SamplePlan PlanSubjects(const ConditionTable& pilot, double alpha) {
  StudySimulation normal(pilot, false, alpha);
  StudySimulation resampled(pilot, true, alpha);
  const auto subjects = static_cast<int>(pilot.subject_count());
  SamplePlan plan{.pilot_subjects = pilot.subject_count()};
  const std::size_t pairs = pilot.condition_count() * (pilot.condition_count() - 1) / 2;
  for (std::size_t a = 0; a < pilot.condition_count(); ++a) {
    for (std::size_t b = a + 1; b < pilot.condition_count(); ++b) {
      const std::size_t test = plan.pairs.size();
      PairPlan pair{.first = pilot.conditions[a], .second = pilot.conditions[b]};
      pair.d_z = TestPair(ConditionValues(pilot, a), ConditionValues(pilot, b), alpha).d_z;
      pair.alone = ByFormula(pair.d_z, alpha);
      pair.holm = Simulated(normal, test);
      pair.holm_resampled = Simulated(resampled, test);
      if (pair.d_z) pair.cautious_d_z = CautiousEffect(*pair.d_z, subjects);
      pair.cautious = ByFormula(pair.cautious_d_z, alpha / static_cast<double>(pairs));
      plan.pairs.push_back(std::move(pair));
    }
  }
  plan.anova = Simulated(normal, pairs);
  plan.anova_resampled = Simulated(resampled, pairs);
  return plan;
}

}  // namespace conav::statistics
