#include <catch2/catch.hpp>
#include <cmath>

#include "nhpm/dataset/annotators.h"
#include "nhpm/dataset/synthesize.h"
#include "support/drawn_map.h"
#include "support/refusal.h"

namespace conav::nhpm {
namespace {

using operators::SnapshotReaderParameters;

/// An annotator who looks at everything, and edits with `probability` at any distance.
SnapshotReaderParameters EditsWith(double probability) {
  SnapshotReaderParameters parameters;
  parameters.edit_probability = probability;
  parameters.decay_cells = 1e6;
  parameters.misplacement_probability = 0.0;
  parameters.lapse_probability = 0.0;
  parameters.guess_probability = 0.0;
  return parameters;
}

/// A false wall at (1,3) down a corridor, seen from (1,1).
PerceptionQuery FalseWallAhead() {
  PerceptionQuery query;
  query.belief = DrawnMap({"########", "#  #   #", "########"});
  query.path = {{1, 1}};
  query.cell = {1, 1};
  query.visible = {{{1, 1}, {1, 2}, {1, 3}, {1, 4}}, {{1, 7}}};
  return query;
}

/// P(removed) of the false wall, the only cell that can be edited.
float OnlyRemoval(const PerceptionAnswer& answer) {
  const float removal = answer.remove[Cell{1, 3}];
  CHECK(ExpectedEdits(answer) == static_cast<double>(removal));
  return removal;
}

/// Everybody's trajectories, bad ones included: what the oracle answers for is not what a filter
/// selects.
std::vector<Trajectory> Unfiltered(int count) {
  std::vector<Trajectory> trajectories;
  Random random(4);
  for (int i = 0; i < count; ++i) {
    const Annotator annotator = DrawAnnotator({}, random);
    auto trajectory = RunMappingTask({}, annotator, static_cast<std::uint64_t>(i));
    REQUIRE(trajectory.has_value());
    trajectories.push_back(*std::move(trajectory));
  }
  return trajectories;
}

using Answers = std::vector<std::vector<PerceptionAnswer>>;

Answers Ask(std::span<const Trajectory> trajectories, const OracleOptions& options = {}) {
  auto answers = OracleAnswers(trajectories, options);
  REQUIRE(answers.has_value());
  return *std::move(answers);
}

TEST_CASE("The oracle's probability is the reader's, an event in none or all draws counts half",
          "[synthesis]") {
  Random random(1);
  const auto removal = [&](double probability, int draws) {
    return OnlyRemoval(OracleAnswer(EditsWith(probability), FalseWallAhead(), draws, random));
  };
  CHECK(removal(0.3, 20000) == Approx(0.3).margin(0.013));  // 4 standard deviations
  CHECK(removal(0.0, 2000) == Approx(0.5 / 2001.0));
  CHECK(removal(1.0, 2000) == Approx(2000.5 / 2001.0));
}

TEST_CASE("The mean over two people counts the looks of both", "[synthesis]") {
  const std::array people{EditsWith(0.0), EditsWith(1.0)};
  const PerceptionQuery query = FalseWallAhead();
  Random random(1);
  const PerceptionAnswer answer = AverageOracleAnswer(people, query, 10, random);
  CHECK(OnlyRemoval(answer) == 10.5F / 21.0F);
  const std::array queries{query, query};
  const auto answers = AverageOracleAnswers(people, queries, {.draws = 20, .threads = 2});
  REQUIRE(answers.size() == 2);
  CHECK(answers[0] == answer);
  CHECK(answers[1] == answer);
}

TEST_CASE("Of the cells to which the oracle gives a probability, that share is edited",
          "[synthesis]") {
  const std::vector<Trajectory> trajectories = Unfiltered(150);
  constexpr int kBins = 5;
  std::array<double, kBins> expected{};
  std::array<double, kBins> edited{};
  std::array<double, kBins> variance{};
  const Answers answers = Ask(trajectories, {.draws = 4000});
  for (std::size_t t = 0; t < trajectories.size(); ++t) {
    for (std::size_t s = 0; s < trajectories[t].segments.size(); ++s) {
      const Segment& segment = trajectories[t].segments[s];
      const PerceptionAnswer& answer = answers[t][s];
      for (std::size_t i = 0; i < segment.belief_after.size(); ++i) {
        const bool was_edited =
            segment.belief_after.values()[i] != segment.query.belief.values()[i];
        const double p = answer.add.values()[i] + answer.remove.values()[i];
        if (p == 0.0) CHECK_FALSE(was_edited);
        const auto bin = static_cast<std::size_t>(std::min(kBins - 1.0, p * kBins));
        expected[bin] += p;
        edited[bin] += was_edited;
        variance[bin] += p * (1.0 - p);
      }
    }
  }
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    CAPTURE(bin, expected[bin], edited[bin], variance[bin]);
    // Lapses tie the cells of a picture together: twice the independent deviation, three times.
    CHECK(std::abs(edited[bin] - expected[bin]) < 6.0 * std::sqrt(variance[bin]));
  }
}

TEST_CASE(
    "The oracle's answers depend on neither threads nor the other trajectories, and each is "
    "reported",
    "[synthesis]") {
  const std::vector<Trajectory> trajectories = Unfiltered(7);
  const Answers answers = Ask(trajectories, {.draws = 2000});
  std::vector<std::size_t> reported;
  OracleOptions options{.draws = 2000, .threads = 3};
  options.progress = [&](std::size_t done, std::size_t total) {
    reported.push_back(done);
    CHECK(total == 7);
  };
  CHECK(Ask(trajectories, options) == answers);
  CHECK(reported == std::vector<std::size_t>{1, 2, 3, 4, 5, 6, 7});
  CHECK(Ask(std::span(trajectories).subspan(4, 1), {.draws = 2000}).front() == answers[4]);
  CHECK(Ask(trajectories, {.draws = 2000, .seed = 2}) != answers);
  CHECK(Ask({}).empty());
}

TEST_CASE("The oracle refuses what it knows nothing of, by name", "[synthesis]") {
  struct Row {
    void (*spoil)(Trajectory&);
    std::string names;
    OracleOptions options{.draws = 2000};
  };
  for (const Row& row :
       std::vector<Row>{{[](auto& one) { one.annotator.clear(); }, "trajectory 1 (s7)"},
                        {[](auto& one) { one.annotator["decay_cells"] = -1.0; }, "decay_cells"},
                        {[](auto& one) { one.segments[3].query.cell.row = 40; }, "segment 3"},
                        {[](auto&) {}, "1999", {.draws = 1999}},
                        {[](auto&) {}, "threads = 0", {.threads = 0}}}) {
    std::vector<Trajectory> trajectories = Unfiltered(2);
    trajectories[1].session = "s7";
    row.spoil(trajectories[1]);
    test::CheckRefusal(OracleAnswers(trajectories, row.options), Catch::Contains(row.names),
                       ErrorCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace conav::nhpm
