#include "planner/methods/operator_model.h"

#include <catch2/catch.hpp>
#include <functional>

#include "unit/planner/search/text_map.h"

namespace conav::planner {
namespace {

/// With a model that expects half of what could be added and a quarter of what could be removed to be
/// edited.
struct EstimateBench {
  EstimateBench() { published[{0, 1}] = 1.0F; }

  PerceptionQuery asked;
  std::optional<Error> failure;
  std::function<void()> while_asked = [] {};
  BeliefGrid published{1, 2, 0.0F};
  BeliefEstimate estimate{std::make_shared<ScriptedPerception>(
      [this](int, auto queries) -> ScriptedPerception::Answers {
        if (failure) return tl::unexpected(*failure);
        asked = queries[0];
        while_asked();
        PerceptionAnswer answer{asked.belief, asked.belief};
        for (float& x : answer.add.values()) x = 0.5F * (1.0F - x);
        for (float& x : answer.remove.values()) x = 0.25F * x;
        return std::vector{answer};
      })};
};

TEST_CASE("a sent picture moves the estimate by x (1 - p_remove) + (1 - x) p_add",
          "[planner][belief_estimate]") {
  EstimateBench bench;
  bench.estimate.Now(bench.published);
  const PerceptionQuery asked{bench.published, {{0, 0}, {0, 1}}, {0, 1}, 0.5, {{{0, 0}}, {{0, 1}}}};
  REQUIRE(bench.estimate.NoteSent(asked.path, asked.cell, asked.heading_rad, asked.visible));
  CHECK(bench.asked == asked);
  const BeliefGrid once = bench.estimate.Now(bench.published);
  CHECK(once[{0, 0}] == 0.5F);
  CHECK(once[{0, 1}] == 0.75F);
  REQUIRE(bench.estimate.NoteSent({}, {0, 0}, 0.0, {}));
  const BeliefGrid twice = bench.estimate.Now(bench.published);
  CHECK(twice[{0, 0}] == 0.5F * 0.75F + 0.5F * 0.5F);
  CHECK(twice[{0, 1}] == 0.75F * 0.75F + 0.25F * 0.5F);
}

TEST_CASE("when the model fails the estimate stays", "[planner][belief_estimate]") {
  EstimateBench bench;
  bench.estimate.Now(bench.published);
  bench.failure = Error{ErrorCode::kTimeout, "gone"};
  const auto noted = bench.estimate.NoteSent({}, {0, 0}, 0.0, {});
  REQUIRE_FALSE(noted);
  CHECK(noted.error().code == ErrorCode::kTimeout);
  CHECK(bench.estimate.Now(bench.published) == bench.published);
}

TEST_CASE("a world that starts again with a map of another size gets a new estimate",
          "[planner][belief_estimate]") {
  EstimateBench bench;
  bench.estimate.Now(bench.published);
  const BeliefGrid larger(2, 2, 0.5F);
  SECTION("after a picture") {}
  SECTION("while the model is asked about a picture of the old one, by another robot") {
    bench.while_asked = [&] { bench.estimate.Now(larger); };
  }
  REQUIRE(bench.estimate.NoteSent({}, {0, 0}, 0.0, {}));
  CHECK(bench.estimate.Now(larger) == larger);
}

/// A corridor of three cells between walls, which the robot knows but for its eastern end; the
/// operator's map has walls in all of it.
class Fixture {
 public:
  Fixture() : known_(3, 5, Occupancy::kOccupied), belief_(3, 5, 1.0F) {
    known_[{1, 1}] = known_[{1, 2}] = Occupancy::kFree;
    known_[{1, 3}] = Occupancy::kUnknown;
    reliability_.Received(belief_, known_);
  }

  /// A picture of which the model expects that the operator removes each wall of the corridor.
  void Send(float probability = 0.5F) {
    PerceptionAnswer edits{Grid<float>(3, 5), Grid<float>(3, 5)};
    for (const int column : {1, 2, 3}) edits.remove[{1, column}] = probability;
    reliability_.Sent(std::move(edits));
  }
  void Edit(Cell cell, bool wall) { belief_[cell] = wall ? 1.0F : 0.0F; }
  double Receive() {
    reliability_.Received(belief_, known_);
    return reliability_.value();
  }

 private:
  OccupancyGrid known_;
  BeliefGrid belief_;
  OperatorReliability reliability_{2.0};
};

TEST_CASE("an operator is trusted at first, and while no picture was sent", "[planner][decision]") {
  CHECK(OperatorReliability(2.0).value() == 1.0);
  Fixture fixture;
  CHECK(fixture.Receive() == 1.0);
}

TEST_CASE("expected edits of known cells that do not come lower the trust, once a picture",
          "[planner][decision]") {
  Fixture fixture;
  for (const int pictures : {1, 2}) {
    fixture.Send();
    CHECK(fixture.Receive() == Approx(2.0 / (2.0 + 2 * pictures * 0.5)));
    CHECK(fixture.Receive() == Approx(2.0 / (2.0 + 2 * pictures * 0.5)));  // nothing was sent since
  }
}

TEST_CASE("an operator who does as expected is trusted, not more than fully",
          "[planner][decision]") {
  Fixture fixture;
  fixture.Send();
  fixture.Edit({1, 1}, false);
  fixture.Edit({1, 2}, false);  // two where one was expected
  CHECK(fixture.Receive() == 1.0);
  fixture.Send();  // nothing is wrong any more that the robot knows of
  CHECK(fixture.Receive() == 1.0);
}

TEST_CASE("cells that the robot does not know say nothing about the operator",
          "[planner][decision]") {
  Fixture fixture;
  fixture.Edit({1, 3}, false);
  CHECK(fixture.Receive() == 1.0);
  fixture.Send();
  fixture.Edit({1, 3}, true);
  CHECK(fixture.Receive() == Approx(2.0 / 3.0));
}

TEST_CASE("an operator who breaks the map loses all trust and wins it back by mending",
          "[planner][decision]") {
  Fixture fixture;
  fixture.Send();
  for (const int column : {0, 1, 2, 3, 4}) fixture.Edit({0, column}, false);
  CHECK(fixture.Receive() == 0.0);
  for (const int column : {0, 1, 2}) fixture.Edit({0, column}, true);
  CHECK(fixture.Receive() == 1.0);
}

TEST_CASE("old edits fade", "[planner][decision]") {
  Fixture fixture;
  for (int i = 0; i < 100; ++i) {
    fixture.Send(1.0F);
    fixture.Receive();
  }
  CHECK(fixture.Receive() == Approx(2.0 / (2.0 + OperatorReliability::kMemoryEdits)));
}

TEST_CASE("on a raster an area counts as one edit", "[planner][decision]") {
  const OccupancyGrid known(50, 50, Occupancy::kFree);
  BeliefGrid belief(50, 50, 0.0F);
  for (int row = 10; row < 20; ++row) {
    for (int column = 10; column < 30; ++column) belief[{row, column}] = 1.0F;  // 200 m2
  }
  OperatorReliability reliability(2.0);
  reliability.Received(belief, known, 1.0);
  reliability.Sent({Grid<float>(50, 50), Grid<float>(50, 50, 0.5F)});
  reliability.Received(belief, known, 1.0);
  CHECK(reliability.value() == Approx(2.0 / (2.0 + 1.0)));
}

TEST_CASE("a view is withheld from when it was answered until the belief in it changes",
          "[planner][sent_views]") {
  CHECK(SentViews{}.Withheld().empty());
  SentViews views;
  views.Sent({{1, 1}, 0.0}, {{{1, 1}, {1, 2}}, {{1, 3}}});
  BeliefGrid belief(4, 5);
  belief[{1, 2}] = 1.0F;  // the edit that answers it
  views.Update(belief);
  views.Update(belief);
  CHECK(views.Withheld() == std::vector<SentViews::View>{{{1, 1}, 0.0}});
  belief[{3, 4}] = 1.0F;  // outside of the view
  views.Update(belief);
  CHECK(views.Withheld().size() == 1);
  belief[{1, 3}] = 1.0F;
  views.Update(belief);
  CHECK(views.Withheld().empty());
}

}  // namespace
}  // namespace conav::planner
