#include <catch2/catch.hpp>

#include "planner/methods/operator_model.h"

using namespace conav;
using conav::planner::SentViews;

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
