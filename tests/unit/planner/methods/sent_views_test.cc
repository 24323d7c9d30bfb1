#include <catch2/catch.hpp>

#include "planner/methods/ig_mcts_method.h"

using namespace conav;
using conav::planner::SentViews;

namespace {

const SentViews::View kView{{1, 1}, 0.0};

SentViews AfterAnswer(const BeliefGrid& belief) {
  SentViews views;
  views.Sent(kView, {{{1, 1}, {1, 2}}, {{1, 3}}});
  views.Update(belief);
  return views;
}

}  // namespace

TEST_CASE("a view that was sent is withheld while the belief in it stays",
          "[planner][sent_views]") {
  const BeliefGrid belief(4, 5);
  SentViews views = AfterAnswer(belief);
  views.Update(belief);
  CHECK(views.Withheld() == std::vector{kView});
}

TEST_CASE("a change outside of the view leaves it withheld, a change inside offers it again",
          "[planner][sent_views]") {
  BeliefGrid belief(4, 5);
  SentViews views = AfterAnswer(belief);
  belief[{3, 4}] = 1.0F;
  views.Update(belief);
  CHECK(views.Withheld().size() == 1);
  belief[{1, 3}] = 1.0F;
  views.Update(belief);
  CHECK(views.Withheld().empty());
}

TEST_CASE("the edit that answers a view does not offer it again", "[planner][sent_views]") {
  SentViews views;
  views.Sent(kView, {{{1, 1}}, {{1, 2}}});
  BeliefGrid answered(4, 5);
  answered[{1, 2}] = 1.0F;
  views.Update(answered);
  views.Update(answered);
  CHECK(views.Withheld().size() == 1);
}

TEST_CASE("before any view is sent nothing is withheld", "[planner][sent_views]") {
  CHECK(SentViews{}.Withheld().empty());
}
