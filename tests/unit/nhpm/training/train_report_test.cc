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

TEST_CASE("The curve shows both losses and the best epoch, also one epoch and losses of zero",
          "[training]") {
  const std::vector<EpochReport> two{{1, 0.1, 0.2}, {2, 0.05, 0.015}};
  const std::string svg = LossCurve(StateOf(two, 2), "a < b");
  CHECK_THAT(svg, Catch::StartsWith("<svg") && Catch::Contains("a &lt; b") &&
                      Catch::Contains("0.01500, epoch 2"));
  CHECK(svg.find("<polyline") != svg.rfind("<polyline"));
  for (const auto& epochs : {two, {{1, 0.1, 0.1}}, {{1, 0.1, 0.0}, {2, 0.0, 0.0}}}) {
    const std::string drawn = LossCurve(StateOf(epochs, 1), "title");
    CHECK_THAT(drawn, !Catch::Contains("nan") && !Catch::Contains("inf"));
    CHECK(test::XmlError(drawn) == "");
  }
}

}  // namespace
}  // namespace conav::nhpm
