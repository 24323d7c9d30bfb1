#include "common/svg/svg_canvas.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

TEST_CASE("signs that mean something in XML are escaped", "[common][svg]") {
  CHECK(EscapeXml("a<b & \"c\">") == "a&lt;b &amp; &quot;c&quot;&gt;");
}

TEST_CASE("a document has its size, its title and a background", "[common][svg]") {
  SvgCanvas canvas;
  canvas.Circle({1.0, 2.0}, 3.0, "class=\"dot\"");
  const std::string svg = canvas.Document(30.0, 40.0, "a < b");
  CHECK_THAT(svg, Catch::Contains("viewBox=\"0 0 30 40\""));
  CHECK_THAT(svg, Catch::Contains("<title>a &lt; b</title>"));
  CHECK_THAT(svg, Catch::Contains("fill=\"#ffffff\""));
  CHECK_THAT(svg, Catch::Contains("<circle cx=\"1.0\" cy=\"2.0\" r=\"3.0\" class=\"dot\"/>"));
}

TEST_CASE("inside a page a picture has a name and no background", "[common][svg]") {
  SvgCanvas canvas;
  canvas.BeginGroup("P(add) = 0.5 > 0.1");
  canvas.Text({1.0, 2.0}, "<i>", "class=\"label\"");
  canvas.EndGroup();
  const std::string svg = canvas.Inline(30.0, 40.0, "a \"map\"");
  CHECK_THAT(svg, Catch::Contains("aria-label=\"a &quot;map&quot;\""));
  CHECK_THAT(svg, Catch::Contains("<g><title>P(add) = 0.5 &gt; 0.1</title>"));
  CHECK_THAT(svg, Catch::Contains(">&lt;i&gt;</text>\n</g>"));
  CHECK_THAT(svg, !Catch::Contains("#ffffff"));
}

}  // namespace
}  // namespace conav
