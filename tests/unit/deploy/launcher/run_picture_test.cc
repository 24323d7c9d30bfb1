#include <catch2/catch.hpp>

#include "support/text.h"
#include "support/xml_check.h"
#include "unit/deploy/launcher/sample_episode.h"

namespace conav::launcher {
namespace {

using test::CountOf;

TEST_CASE("the picture shows three maps, the path, the picture that was sent and each mistake",
          "[launcher]") {
  const std::string svg = EpisodeSvg(SampleEpisode(), "seed 1");
  CHECK(CountOf(svg, "width=\"23.0\"") == 3 * 25);
  CHECK(CountOf(svg, "<polyline") == 1);
  CHECK(CountOf(svg, "operator's map before") == 1);
  CHECK(CountOf(svg, "operator's map after 0 edits") == 1);
  CHECK(CountOf(svg, "in this direction") == 1);
  // Mistakes before, after (nothing was edited) and in the legend; a cross is two lines, the legend
  // has one more.
  CHECK(CountOf(svg, "<line") == 3 * 2 + 1);
  CHECK(CountOf(svg, "fill=\"none\"/>") == 3);
  CHECK(test::XmlError(svg) == "");
}

TEST_CASE("among several robots each goal has the colour and the name of its robot", "[launcher]") {
  const std::string blue = "fill=\"#0072B2\" stroke=\"#000000\"";
  const std::string orange = "fill=\"#D55E00\" stroke=\"#000000\"";
  const std::string yellow = "fill=\"#F0E442\" stroke=\"#000000\"";
  Episode episode = SampleEpisode();
  const std::string alone = EpisodeSvg(episode, "");
  CHECK(CountOf(alone, yellow) == 2);  // the goal and the legend
  CHECK(CountOf(alone, ">goal<") == 1);
  CHECK(CountOf(alone, ">r1<") == 1);  // its start

  episode.robots.push_back(episode.robots[0]);
  episode.robots[1].name = "r2";
  CHECK(CountOf(EpisodeSvg(episode, ""), yellow) == 2 + 1);  // shared

  episode.robots[1].goals = {{1, 1}, {2, 3}};
  const std::string own = EpisodeSvg(episode, "");
  CHECK(CountOf(own, yellow) == 0);
  CHECK(CountOf(own, blue) == 1 + 1);
  CHECK(CountOf(own, orange) == 2);
  CHECK(CountOf(own, ">r1<") == 1 + 1);
  CHECK(CountOf(own, ">r2<") == 1 + 2);
  CHECK(CountOf(own, ">its goal<") == 1);

  episode.robots[1].world = "w2";
  CHECK(CountOf(EpisodeSvg(episode, ""), yellow) == 2);  // alone in its world
}

TEST_CASE("a world that never reported leaves an empty picture", "[launcher]") {
  const std::string svg = EpisodeSvg(MakeEpisode(1, 1), "no & thing");
  CHECK_THAT(svg, Catch::Contains("<title>no &amp; thing</title>"));
  CHECK(test::XmlError(svg) == "");
}

}  // namespace
}  // namespace conav::launcher
