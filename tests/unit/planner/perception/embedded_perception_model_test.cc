#include <catch2/catch.hpp>

#include "conformance/perception_model_conformance.h"
#include "nhpm/model/perception_network.h"
#include "planner/perception/embedded_model.h"
#include "support/test_weights.h"

namespace conav::planner {
namespace {

using conformance::MakeQuery;

EmbeddedPerceptionModel NetworkOf(int rows, int columns) {
  return EmbeddedPerceptionModel(
      std::make_shared<nhpm::PerceptionNetwork>(test::UntrainedNetwork(1, rows, columns)));
}

TEST_CASE("Without a model the embedded one is the GLPF", "[planner][perception]") {
  EmbeddedPerceptionModel model;
  CHECK(model.name() == "glpf");
  CHECK(model.identity() == "glpf " + nhpm::Glpf().identity().checksum);
}

TEST_CASE("Other weights are another identity", "[planner][perception]") {
  EmbeddedPerceptionModel first(
      std::make_shared<nhpm::PerceptionNetwork>(test::UntrainedNetwork(1)));
  EmbeddedPerceptionModel second(
      std::make_shared<nhpm::PerceptionNetwork>(test::UntrainedNetwork(2)));
  CHECK(first.name() == second.name());
  CHECK(first.identity() != second.identity());
}

TEST_CASE("A network that was made for another grid size is unavailable, with both sizes",
          "[planner][perception]") {
  auto model = NetworkOf(13, 13);
  const std::vector queries{MakeQuery(1, 9, 11)};
  const auto answers = model.Predict(queries);
  REQUIRE_FALSE(answers);
  CHECK(answers.error().code == ErrorCode::kUnavailable);
  CHECK_THAT(answers.error().text, Catch::Contains("13 x 13") && Catch::Contains("9 x 11"));
  CHECK(NetworkOf(9, 11).Predict(queries));
}

TEST_CASE("A query that nobody can answer is refused as such", "[planner][perception]") {
  auto model = NetworkOf(9, 11);
  std::vector queries{MakeQuery(1, 9, 11)};
  queries[0].cell = {-1, 0};
  CHECK(model.Predict(queries).error().code == ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace conav::planner
