#include "nhpm/model/glpf.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "common/runtime/config.h"

namespace conav::nhpm {
namespace {

/// Round numbers: x(d) = 2^-d, P(x) = 0.1 + 0.7 / (1 + e^(-4 (x - 0.5))).
GlpfParameters RoundParameters() {
  return {.alpha_d = std::log(2.0), .alpha_m = 0.5, .beta = 4.0, .rho = 0.1, .lambda = 0.2};
}

/// 5 x 5, camera in the middle, all free on the belief but for the border.
PerceptionQuery QueryInTheMiddle() {
  PerceptionQuery query;
  query.belief = BeliefGrid(5, 5, 0.0F);
  for (std::size_t i = 0; i < 25; ++i) {
    if (query.belief.OnBorder(query.belief.CellAt(i))) query.belief.values()[i] = 1.0F;
  }
  query.cell = {2, 2};
  query.visible.free = {{2, 2}};
  return query;
}

PerceptionAnswer Ask(Glpf model, const PerceptionQuery& query) {
  const auto answers = model.Predict({&query, 1});
  REQUIRE(answers);
  return answers->front();
}

TEST_CASE("The response is the logistic function of the paper", "[model]") {
  Glpf model(RoundParameters());
  CHECK(model.Stimulus(0.0) == 1.0);
  CHECK(model.Stimulus(1.0) == Approx(0.5));
  CHECK(model.Stimulus(3.0) == Approx(0.125));
  CHECK(model.Response(0.5) == Approx(0.45));         // the middle: 0.1 + 0.7 / 2
  CHECK(model.Response(0.0) == Approx(0.183442047));  // 0.1 + 0.7 / (1 + e^2)
  CHECK(model.Response(1.0) == Approx(0.716557953));  // 0.1 + 0.7 / (1 + e^-2)
  GlpfParameters tied = RoundParameters();
  tied.tie_alphas = true;  // the decay is the midpoint, too
  CHECK(Glpf(tied).Response(std::log(2.0)) == Approx(0.45));
  GlpfParameters steep = RoundParameters();
  steep.beta = 1000.0;  // rho and lambda are its bounds
  CHECK(Glpf(steep).Response(0.0) == Approx(0.1));
  CHECK(Glpf(steep).Response(1.0) == Approx(0.8));
}

TEST_CASE("A mistake is edited with the response to its distance, an uncertain belief is a mixture",
          "[model]") {
  PerceptionQuery query = QueryInTheMiddle();
  query.visible.walls = {{2, 3}};
  // d = 1 where the belief is wrong, no stimulus where it is right.
  for (const float wall : {0.0F, 0.25F, 1.0F}) {
    query.belief[{2, 3}] = wall;
    const PerceptionAnswer answer = Ask(Glpf(RoundParameters()), query);
    CHECK(answer.add[{2, 3}] == Approx((1.0F - wall) * 0.45F));
    CHECK(answer.remove[{2, 3}] == Approx(wall * 0.183442047F));
    CHECK(answer.add[{1, 1}] == Approx(0.183442047));
    CHECK(answer.add[{2, 2}] == Approx(0.183442047));
  }
  PerceptionQuery false_wall = QueryInTheMiddle();
  false_wall.belief[{1, 1}] = 1.0F;
  false_wall.visible.free = {{1, 1}, {2, 2}};
  const PerceptionAnswer removed = Ask(Glpf(RoundParameters()), false_wall);
  // d = sqrt 2: x = 2^-sqrt(2) = 0.375214, P = 0.1 + 0.7 / (1 + e^0.499143)
  CHECK(removed.remove[{1, 1}] == Approx(0.364419).epsilon(1e-5));
  CHECK(removed.add[{1, 1}] == 0.0F);
}

TEST_CASE("The path shows walls of the belief to be free, unless only the view counts", "[model]") {
  PerceptionQuery query = QueryInTheMiddle();
  query.belief[{2, 1}] = 1.0F;
  query.path = {{2, 1}, {2, 2}};
  CHECK(Ask(Glpf(RoundParameters()), query).remove[{2, 1}] == Approx(0.45));
  GlpfParameters parameters = RoundParameters();
  parameters.visible_only = true;
  CHECK(Ask(Glpf(parameters), query).remove[{2, 1}] == Approx(0.183442047));
}

TEST_CASE("By default near mistakes are noticed, far ones less, and no mistake means no edit",
          "[model]") {
  Glpf model;
  CHECK(model.Response(model.Stimulus(1.0)) > 0.85);
  CHECK(model.Response(model.Stimulus(7.0)) == Approx(0.43).margin(0.02));
  CHECK(model.Response(model.Stimulus(12.0)) < 0.01);
  PerceptionQuery query;
  query.belief = BeliefGrid(15, 15, 0.0F);
  query.cell = {7, 7};
  query.visible.free = {{7, 7}, {7, 8}};
  CHECK(ExpectedEdits(Ask(model, query)) < 0.01);
  query.belief = BeliefGrid(200, 200, 0.0F);
  CHECK(ExpectedEdits(Ask(model, query)) < 0.7);
}

TEST_CASE("The version names the parameters, which are read from a config section", "[model]") {
  CHECK(Glpf().version() ==
        "1 alpha_d=0.1 alpha_m=0.5 beta=24 rho=1e-05 lambda=0.1 visible_only=false");
  GlpfParameters parameters;
  ReadConfig(YAML::Load("{alpha_d: 0.25, visible_only: true}"), "nhpm.glpf", parameters);
  CHECK(parameters.alpha_d == 0.25);
  CHECK(parameters.visible_only);
  CHECK_THROWS_AS(ReadConfig(YAML::Load("{lambda: 0.6}"), "nhpm.glpf", parameters), StartupError);
}

}  // namespace
}  // namespace conav::nhpm
