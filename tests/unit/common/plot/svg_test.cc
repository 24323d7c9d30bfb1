#include "common/plot/svg.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "common/runtime/file.h"
#include "support/xml_check.h"

namespace conav {
namespace {

TEST_CASE("a document has its size and title, no attribute is there twice", "[svg]") {
  SvgCanvas dot;
  dot.Circle({1.0, 2.0}, 3.0, "class=\"dot\"");
  const std::string document = dot.Document(30.0, 40.0, "a < b & c");
  for (const char* part :
       {"viewBox=\"0 0 30 40\"", "<title>a &lt; b &amp; c</title>", "fill=\"#ffffff\"",
        "<circle cx=\"1.0\" cy=\"2.0\" r=\"3.0\" class=\"dot\"/>"}) {
    CHECK_THAT(document, Catch::Contains(part));
  }
  SvgCanvas canvas;
  canvas.BeginGroup("P(add) = 0.5 > 0.1");
  canvas.Text({1.0, 2.0}, "<i>", "class=\"label\"");
  canvas.EndGroup();
  const std::string svg = canvas.Inline(30.0, 40.0, "a \"map\"");
  CHECK_THAT(svg, Catch::Contains("aria-label=\"a &quot;map&quot;\""));
  CHECK_THAT(svg, Catch::Contains("<g><title>P(add) = 0.5 &gt; 0.1</title>"));
  CHECK_THAT(svg, Catch::Contains(">&lt;i&gt;</text>\n</g>"));
  CHECK_THAT(svg, !Catch::Contains("#ffffff"));
  SvgCanvas picture;  // bytes of RFC 4648, section 10
  for (const std::string bytes : {"foob", "fooba", "foobar"}) {
    picture.Jpeg({1.0, 2.0}, 30.0, 20.0, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  }
  const std::string pictures = picture.Inline(30.0, 40.0, "t");
  for (const char* bytes : {"base64,Zm9vYg==\"", "base64,Zm9vYmE=\"", "base64,Zm9vYmFy\""}) {
    CHECK_THAT(pictures, Catch::Contains(bytes));
  }
  CHECK(test::XmlError(pictures) == "");
  SvgCanvas twice;
  twice.Polyline({{1.0, 2.0}, {3.0, 4.0}}, R"(fill="#eee" stroke="red"  stroke="blue")");
  twice.Polyline({{1.0, 2.0}}, "");
  twice.Circle({1.0, 2.0}, 3.0, R"(r="5")");
  twice.Text({1.0, 2.0}, "\x01", R"(class="label")");
  const std::string once = twice.Inline(30.0, 40.0, "t");
  CHECK_THAT(once, Catch::Contains(R"(points="1.0,2.0 3.0,4.0" fill="#eee" stroke="blue"/>)"));
  CHECK_THAT(once, Catch::Contains(R"(<polyline points="1.0,2.0" fill="none"/>)"));
  CHECK_THAT(once, Catch::Contains(R"(<circle cx="1.0" cy="2.0" r="5"/>)"));
  CHECK(test::XmlError(once) == "");
}

TEST_CASE("the pictures of the documents are well-formed, what is no XML is found", "[svg]") {
  std::size_t snapshots = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CONAV_SOURCE_DIR "/docs")) {
    if (entry.path().extension() != ".svg") continue;
    INFO(entry.path());
    CHECK(test::XmlError(ReadFile(entry.path()).value()) == "");
    ++snapshots;
  }
  CHECK(snapshots > 0);
  for (const char* good :
       {"<a/>", "<!DOCTYPE html>\n<a b=\"1\" c=\"&lt;\"><d>x &amp; y</d ></a>"}) {
    CHECK(test::XmlError(good) == "");
  }
  for (const char* bad :
       {"", "text", "<a>", "<a></b>", "</a>", "<a><b></a></b>", "<a b=\"1\" b=\"1\"/>", "<a b=1/>",
        "<a b/>", "<a b=\"1/>", "<a>1 & 2</a>", "<a>&nbsp;</a>", "<a", "<a>\x01</a>",
        "<a>1 < 2</a>", "<!DOCTYPE"}) {
    CAPTURE(bad);
    CHECK(test::XmlError(bad) != "");
  }
}

}  // namespace
}  // namespace conav
