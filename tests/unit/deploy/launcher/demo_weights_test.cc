#include <catch2/catch.hpp>

#include "common/runtime/file.h"
#include "launcher/demo_plan.h"
#include "support/test_weights.h"

namespace conav::launcher {
namespace {

std::string Refusal(const DemoOptions& options) {
  const auto checked = CheckWeights(options);
  return checked ? "" : checked.error().text;
}

TEST_CASE("weights that are none are refused with the reason", "[launcher][weights]") {
  const test::WeightsFolder folder;
  DemoOptions options;
  CHECK(Refusal(options) == "");
  options.weights = folder.path() / "notes.nhpm";
  REQUIRE(WriteFile(options.weights, "no weights"));
  CHECK_THAT(Refusal(options), Catch::StartsWith("--weights " + options.weights.string() + ": "));
  CHECK(WeightsChecksum(options).empty());
}

TEST_CASE("weights for maps of another size are refused, naming both", "[launcher][weights]") {
  const test::WeightsFolder folder;
  DemoOptions options;
  options.weights = folder.Write("any", test::UntrainedNetwork(1));
  CHECK(Refusal(options) == "");
  options.weights = folder.Write("bound", test::UntrainedNetwork(1, 13, 13));
  CHECK(Refusal(options) == "");
  options.preset = "15x15";
  CHECK_THAT(Refusal(options),
             Catch::EndsWith("is for maps of 13 x 13 cells; this run's have 17 x 17"));
  options.preset = "unknown";
  CHECK(Refusal(options) == "");  // CheckWorlds says it
}

TEST_CASE("the checksum is that of the weights that shall answer", "[launcher][weights]") {
  const test::WeightsFolder folder;
  const nhpm::NetworkModel everybody = test::UntrainedNetwork(1);
  const nhpm::NetworkModel anna = test::UntrainedNetwork(2);
  DemoOptions options;
  options.weights = folder.Write("everybody", everybody);
  CHECK(WeightsChecksum(options) == nhpm::ChecksumOf(everybody));
  options.person = "anna";
  options.person_weights = folder.path();
  CHECK_THAT(Refusal(options), Catch::StartsWith("--person-weights "));
  folder.Write("anna", anna);
  CHECK(Refusal(options) == "");
  CHECK(WeightsChecksum(options) == nhpm::ChecksumOf(anna));
  options.model = "glpf";
  CHECK(WeightsChecksum(options).empty());
}

}  // namespace
}  // namespace conav::launcher
