#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "nhpm/evaluation/evaluation.h"
#include "nhpm/evaluation/metrics.h"
#include "unit/nhpm/evaluation/samples.h"

namespace conav::nhpm {
namespace {

const GlpfParameters kTruth{
    .alpha_d = 0.25, .alpha_m = 0.4, .beta = 9.0, .rho = 0.02, .lambda = 0.15};

/// As many edits, in fractions, as the parameters promise.
GlpfStatistics ExactStatistics(const GlpfParameters& parameters) {
  Glpf model(parameters);
  GlpfStatistics statistics;
  statistics.unstimulated = {1e5, 1e5 * model.Response(0.0)};
  for (int distance = 0; distance <= 100; ++distance) {
    const double response = model.Response(model.Stimulus(std::sqrt(distance)));
    statistics.seen[distance] = {1000.0, 1000.0 * response};
    statistics.on_path[distance] = {
        100.0, 100.0 * (parameters.visible_only ? model.Response(0.0) : response)};
  }
  return statistics;
}

TEST_CASE("Cells are counted by stimulus", "[glpf_fit]") {
  Segment segment = EmptySegment();
  PerceptionQuery& query = segment.query;
  query.belief[{1, 1}] = 1.0F;
  query.belief[{2, 1}] = 1.0F;
  query.belief[{3, 3}] = 1.0F;
  query.path = {{2, 1}, {2, 2}};
  query.visible = {{{1, 1}, {2, 2}}, {{2, 3}, {2, 4}, {3, 3}}};
  segment.belief_after = query.belief;
  Flip(segment, {1, 1});
  Flip(segment, {1, 2});
  const Segment* pointer = &segment;
  const GlpfStatistics statistics = CountStimuli({&pointer, 1});
  REQUIRE(statistics.seen.size() == 2);
  CHECK(statistics.seen.at(2).outputs == 1.0);  // (1,1): a wall shown free
  CHECK(statistics.seen.at(2).edits == 1.0);
  CHECK(statistics.seen.at(1).outputs == 1.0);  // (2,3): a wall that the map lacks
  CHECK(statistics.seen.at(1).edits == 0.0);
  REQUIRE(statistics.on_path.size() == 1);
  CHECK(statistics.on_path.at(1).outputs == 1.0);  // (2,1): driven through
  CHECK(statistics.unstimulated.outputs == 6.0);
  CHECK(statistics.unstimulated.edits == 1.0);  // (1,2), a guess
  CHECK(statistics.outputs() == 9.0);
}

TEST_CASE("The loss of counted cells is that of the model's answers", "[glpf_fit]") {
  Glpf people(kTruth);
  const SegmentSet set = SegmentsOf(people, 2, 10, 7);
  GlpfParameters parameters = kTruth;
  parameters.visible_only = GENERATE(false, true);
  const auto outcomes = PairOutcomes(AllSegments(set), *Glpf(parameters).Predict(Queries(set)));
  CHECK(GlpfLoss(CountStimuli(AllSegments(set)), parameters) ==
        Approx(MeanCrossEntropy(*outcomes).unmasked).epsilon(1e-6));
  CHECK(GlpfLoss({}, parameters) == 0.0);
}

TEST_CASE("Parameters are recovered from as many edits as they promise", "[glpf_fit]") {
  GlpfParameters truth = kTruth;
  truth.visible_only = GENERATE(false, true);
  const GlpfFit fit = FitGlpf(ExactStatistics(truth));
  CHECK(FitGlpf(ExactStatistics(truth)).best.loss == fit.best.loss);
  const GlpfParameters& found = fit.best.parameters;
  for (const auto value : {&GlpfParameters::alpha_d, &GlpfParameters::alpha_m,
                           &GlpfParameters::beta, &GlpfParameters::rho, &GlpfParameters::lambda}) {
    CHECK(found.*value == Approx(truth.*value).epsilon(0.01));
  }
  CHECK(found.visible_only == truth.visible_only);
  CHECK(fit.variants.size() == 2);
}

TEST_CASE("The rates stay within their bounds, also of people who overlook most near mistakes",
          "[glpf_fit]") {
  GlpfStatistics statistics;
  statistics.unstimulated = {100.0, 90.0};  // a guess rate of 0.9 cannot be
  statistics.seen[1] = {100.0, 10.0};
  const GlpfParameters found = FitGlpf(statistics).best.parameters;
  CHECK(found.rho == Approx(0.5).margin(1e-3));
  statistics = {};
  statistics.unstimulated = {100000.0, 0.0};
  for (const int squared : {1, 4, 9, 16}) statistics.seen[squared] = {1000.0, 300.0};
  for (const int squared : {36, 49, 64, 81}) statistics.seen[squared] = {1000.0, 0.0};
  CHECK(FitGlpf(statistics).best.parameters.lambda == Approx(0.5).margin(1e-3));
}

double Rosenbrock(std::span<const double> at) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double valley = at[i + 1] - at[i] * at[i];
    sum += 100.0 * valley * valley + (1.0 - at[i]) * (1.0 - at[i]);
  }
  return sum;
}

TEST_CASE("Minima are found, of one, two and four coordinates, around values that are no numbers",
          "[nelder_mead]") {
  const auto found = MinimiseNelderMead(Rosenbrock, std::vector{-1.2, 1.0});
  CHECK(found.converged);
  CHECK(found.position[0] == Approx(1.0).margin(1e-4));
  CHECK(found.position[1] == Approx(1.0).margin(1e-4));
  CHECK(found.value < 1e-9);
  const auto four = MinimiseNelderMead(Rosenbrock, std::vector{0.5, 0.5, 0.5, 0.5},
                                       {.iterations = 10000, .tolerance = 1e-14});
  for (const double coordinate : four.position) CHECK(coordinate == Approx(1.0).margin(1e-4));
  const auto logarithm = [](std::span<const double> at) {  // no number at 0 and below
    return at[0] <= 0.0 ? std::numeric_limits<double>::quiet_NaN() : at[0] - std::log(at[0]);
  };
  CHECK(MinimiseNelderMead(logarithm, std::vector{0.1}).position[0] == Approx(1.0).margin(1e-4));
}

TEST_CASE("A search ends when its iterations are spent, equal values far apart are no minimum yet",
          "[nelder_mead]") {
  const auto found = MinimiseNelderMead(Rosenbrock, std::vector{-1.2, 1.0}, {.iterations = 5});
  CHECK(found.iterations == 5);
  CHECK_FALSE(found.converged);
  CHECK(found.value < Rosenbrock(std::vector{-1.2, 1.0}));
  const auto flat = [](std::span<const double>) { return 1.0; };
  CHECK_FALSE(MinimiseNelderMead(flat, std::vector{0.0, 0.0}, {.iterations = 10}).converged);
  CHECK(MinimiseNelderMead(flat, std::vector{0.0, 0.0}).converged);
}

}  // namespace
}  // namespace conav::nhpm
