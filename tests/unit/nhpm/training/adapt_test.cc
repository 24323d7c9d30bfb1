#include "nhpm/training/adapt.h"

#include <catch2/catch.hpp>

#include "nhpm/training/batch_pass.h"
#include "nhpm/training/trainer.h"
#include "unit/common/segments/support/sample_segments.h"
#include "unit/nhpm/training/made_up_examples.h"

namespace conav::nhpm {
namespace {

constexpr int kRows = 5;
constexpr int kColumns = 6;

/// Trajectories of three examples each.
std::vector<ExampleSet> Groups(int count, std::uint64_t seed) {
  std::vector<ExampleSet> groups;
  for (int i = 0; i < count; ++i) {
    groups.push_back(MadeUpExamples(kRows, kColumns, 3, seed + static_cast<std::uint64_t>(i)));
  }
  return groups;
}

/// Somebody who never removes a wall.
std::vector<ExampleSet> OfSomebodyElse(std::vector<ExampleSet> groups) {
  for (ExampleSet& group : groups) {
    for (Example& example : group.examples) {
      for (std::size_t i = 1; i < example.labels.size(); i += kOutputChannels) {
        if (example.labels[i] == OutputLabel::kEdited) example.labels[i] = OutputLabel::kKept;
      }
    }
  }
  return groups;
}

double LossOn(const NetworkWeights& weights, const std::vector<ExampleSet>& groups) {
  BatchPass pass(weights.shape, kRows, kColumns, 1);
  double sum = 0.0;
  for (const ExampleSet& group : groups) {
    sum += pass.MeanLoss(TrainingWeights(weights), group.examples);
  }
  return sum / static_cast<double>(groups.size());
}

const StopToken kNever;

/// A network that knows the rule of the made-up examples.
NetworkWeights Base() {
  const ExampleSet train = MadeUpExamples(kRows, kColumns, 60, 1);
  const TrainingOptions options{.width = 16, .epochs = 60, .batch = 10, .learning_rate = 5e-3};
  Trainer trainer(options, train, train, 2, InitialTrainingState(options, 0.1));
  while (!trainer.finished()) REQUIRE(trainer.RunEpoch(kNever));
  return trainer.state().best;
}

AdaptOptions SmallOptions() { return {.epochs = 12, .batch = 4, .learning_rate = 3e-3}; }

TEST_CASE("A network adapted to a person is better at this person's unseen edits", "[adapt]") {
  const NetworkWeights base = Base();
  const auto person = OfSomebodyElse(Groups(8, 100));
  const auto unseen = OfSomebodyElse(Groups(8, 200));
  const Adaptation adapted = Adapt(base, person, SmallOptions(), 2, kNever).value();
  CHECK(adapted.epochs > 0);
  CHECK(adapted.held_out_loss < adapted.base_loss);
  CHECK(adapted.base_loss == Approx(LossOn(base, person)).epsilon(1e-9));
  CHECK(LossOn(adapted.weights, unseen) < 0.5 * LossOn(base, unseen));
  for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {  // the first two stay
    CHECK((adapted.weights.weights[layer] == base.weights[layer]) == (layer < 2));
    CHECK((adapted.weights.biases[layer] == base.biases[layer]) == (layer < 2));
  }
}

TEST_CASE("Where nothing is better than the base the base stays", "[adapt]") {
  const NetworkWeights base = Base();
  AdaptOptions options = SmallOptions();
  options.learning_rate = 10.0;                               // each step breaks it
  options.slope_deviation = options.offset_deviation = 1e-6;  // people are all alike
  const Adaptation adapted = Adapt(base, Groups(4, 100), options, 1, kNever).value();
  CHECK(adapted.epochs == 0);
  CHECK((adapted.weights == base));
  CHECK(adapted.held_out_loss == adapted.base_loss);
}

TEST_CASE("Few pictures calibrate the outputs, and teach nothing else", "[adapt]") {
  const NetworkWeights base = Base();
  AdaptOptions options = SmallOptions();
  options.learning_rate = 1e-12;  // no fine-tuning
  const auto unseen = OfSomebodyElse(Groups(8, 200));
  double before = LossOn(base, unseen);
  for (const int groups : {2, 8}) {  // the more the better
    const Adaptation adapted =
        Adapt(base, OfSomebodyElse(Groups(groups, 100)), options, 1, kNever).value();
    CHECK(adapted.calibrated);
    CHECK(adapted.epochs == 0);
    const double after = LossOn(adapted.weights, unseen);
    CHECK(after < before);
    before = after;
    for (std::size_t layer = 0; layer < kNetworkLayers; ++layer) {
      CHECK((adapted.weights.weights[layer] == base.weights[layer]) ==
            (layer + 1 < kNetworkLayers));
    }
  }
}

TEST_CASE("A stronger pull stays nearer to the base", "[adapt]") {
  const NetworkWeights base = InitialWeights({16}, 3, -2.0F);
  const auto distance = [&](double pull) {
    AdaptOptions options = SmallOptions();
    options.pulls = {pull};
    const Adaptation adapted = Adapt(base, Groups(20, 100), options, 1, kNever).value();
    REQUIRE(adapted.epochs > 0);
    double sum = 0.0;
    for (std::size_t i = 0; i < base.weights[2].size(); ++i) {
      const double change = static_cast<double>(adapted.weights.weights[2][i] - base.weights[2][i]);
      sum += change * change;
    }
    return sum;
  };
  CHECK(distance(1.0) < 0.5 * distance(0.0));
}

TEST_CASE("Fewer than two groups with examples are refused, an adaptation can be stopped",
          "[adapt]") {
  const NetworkWeights base = InitialWeights({16}, 3);
  StopToken stop;
  CHECK_FALSE(Adapt(base, {}, {}, 1, stop));
  CHECK_FALSE(Adapt(base, {Groups(1, 1)[0], ExampleSet{}}, {}, 1, stop));
  stop.RequestStop();
  const auto adapted = Adapt(base, Groups(2, 1), {}, 1, stop);
  REQUIRE_FALSE(adapted);
  CHECK(adapted.error().code == ErrorCode::kUnavailable);
}

Trajectory TrajectoryOf(const std::string& participant, std::size_t segments) {
  Trajectory trajectory;
  trajectory.participant = participant;
  trajectory.segments.assign(segments, tests::SampleSegment());
  return trajectory;
}

SegmentSet AnnaAndBert() {
  return {{TrajectoryOf("anna", 1), TrajectoryOf("bert", 2), TrajectoryOf("anna", 3)}};
}

TEST_CASE("Trajectories are sorted by participant, and held out whole where there are several",
          "[adapt]") {
  const auto people = PeopleOf(AnnaAndBert());
  REQUIRE(people.size() == 2);
  CHECK(people[0].participant == "anna");
  REQUIRE(people[0].set.trajectories.size() == 2);
  CHECK(people[0].set.trajectories[1].segments.size() == 3);
  CHECK(people[1].participant == "bert");
  CHECK(PeopleOf({}).empty());
  const auto of_anna = AdaptationGroups(people[0].set, {});
  REQUIRE(of_anna.size() == 2);
  CHECK(of_anna[1].examples.size() == 3);
  const auto of_bert = AdaptationGroups(people[1].set, {});
  REQUIRE(of_bert.size() == 2);
  CHECK(of_bert[0].examples.size() == 1);
  CHECK(of_bert[1].rows == 4);
}

TEST_CASE("A participant is found by name, the only one without, the refusal names some who exist",
          "[adapt]") {
  const auto people = PeopleOf(AnnaAndBert());
  CHECK(FindPerson(people, "bert").value().participant == "bert");
  CHECK(FindPerson({people[0]}, "").value().participant == "anna");
  CHECK_THAT(FindPerson(people, "carl").error().text,
             Catch::Contains("'carl'") && Catch::Contains("2 (anna, bert)"));
  CHECK_THAT(FindPerson(people, "").error().text, Catch::StartsWith("--participant"));
  CHECK_THAT(FindPerson(std::vector<Person>(20, Person{"p", {}}), "q").error().text,
             Catch::Contains("20 (p, p, p, p, p, p, p, p, ...)"));
}

}  // namespace
}  // namespace conav::nhpm
