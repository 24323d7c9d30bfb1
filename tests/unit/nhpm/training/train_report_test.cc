#include <catch2/catch.hpp>

#include "nhpm/training/train_command.h"
#include "support/xml_check.h"

namespace conav::nhpm {
namespace {

TrainingState StateOf(std::vector<EpochReport> epochs, int best_epoch) {
  TrainingState state;
  state.epochs = std::move(epochs);
  state.best_epoch = best_epoch;
  return state;
}

TEST_CASE("The curve shows both losses and marks the best epoch", "[training]") {
  const std::string svg =
      LossCurve(StateOf({{1, 0.1, 0.2}, {2, 0.05, 0.015}, {3, 0.04, 0.03}}, 2), "a < b");
  CHECK_THAT(svg, Catch::StartsWith("<svg") && Catch::Contains("a &lt; b") &&
                      Catch::Contains("best 0.01500, epoch 2"));
  CHECK(svg.find("<polyline") != svg.rfind("<polyline"));
}

TEST_CASE("A single epoch and a loss of zero can be drawn, too", "[training]") {
  for (const auto& epochs : std::vector<std::vector<EpochReport>>{
           {{1, 0.1, 0.2}, {2, 0.05, 0.015}}, {{1, 0.1, 0.1}}, {{1, 0.1, 0.0}, {2, 0.0, 0.0}}}) {
    const std::string svg = LossCurve(StateOf(epochs, 1), "title");
    CHECK_THAT(svg, !Catch::Contains("nan") && !Catch::Contains("inf"));
    CHECK(test::XmlError(svg) == "");
  }
}

}  // namespace
}  // namespace conav::nhpm
