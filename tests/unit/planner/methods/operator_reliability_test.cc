#include <catch2/catch.hpp>

#include "planner/methods/operator_model.h"

namespace conav::planner {
namespace {

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

TEST_CASE("expected edits of known cells that do not come lower the trust", "[planner][decision]") {
  Fixture fixture;
  fixture.Send();
  CHECK(fixture.Receive() == Approx(2.0 / (2.0 + 2 * 0.5)));
  fixture.Send();
  CHECK(fixture.Receive() == Approx(2.0 / (2.0 + 4 * 0.5)));
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

TEST_CASE("a question that is not followed by a picture is forgotten", "[planner][decision]") {
  Fixture fixture;
  fixture.Send();
  const double once = fixture.Receive();
  CHECK(fixture.Receive() == once);
}

}  // namespace
}  // namespace conav::planner
