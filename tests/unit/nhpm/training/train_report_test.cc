#include "nhpm/training/train_report.h"

#include <catch2/catch.hpp>

#include "support/xml_check.h"

namespace conav::nhpm {
namespace {

TrainingState StateOf(std::vector<EpochReport> epochs, int best_epoch) {
  TrainingState state;
  state.epochs = std::move(epochs);
  state.best_epoch = best_epoch;
  return state;
}

TEST_CASE("The curve shows both losses and marks the best epoch", "[nhpm][training]") {
  const std::string svg =
      LossCurve(StateOf({{1, 0.1, 0.2}, {2, 0.05, 0.015}, {3, 0.04, 0.03}}, 2), "a < b");
  CHECK_THAT(svg, Catch::StartsWith("<svg") && Catch::Contains("a &lt; b") &&
                      Catch::Contains("best 0.01500, epoch 2"));
  std::size_t lines = 0;
  for (std::size_t at = svg.find("<polyline"); at != std::string::npos;
       at = svg.find("<polyline", at + 1)) {
    ++lines;
  }
  CHECK(lines == 2);
  CHECK(test::XmlError(svg) == "");
  CHECK_THAT(svg, !Catch::Contains("nan") && !Catch::Contains("inf"));
}

TEST_CASE("A single epoch and a loss of zero can be drawn", "[nhpm][training]") {
  const std::string one = LossCurve(StateOf({{1, 0.1, 0.1}}, 1), "one");
  const std::string zero = LossCurve(StateOf({{1, 0.1, 0.0}, {2, 0.0, 0.0}}, 1), "zero");
  for (const std::string& svg : {one, zero}) {
    CHECK_THAT(svg, !Catch::Contains("nan") && !Catch::Contains("inf"));
    CHECK(test::XmlError(svg) == "");
  }
}

}  // namespace
}  // namespace conav::nhpm
