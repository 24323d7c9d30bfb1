#include <catch2/catch.hpp>
#include <regex>

#include "operator/recording/idl_text.h"
#include "operator/recording/mcap_file.h"

namespace conav::bag {
namespace {

const std::string kBegin = "#include \"x.idl\"\nmodule demo { module msg {\n";
const std::string kEnd = "\n}; };\n";
const std::string kLine(80, '=');

/// The definition of demo/msg/A.
std::string TextOf(const std::string& members) {
  const auto schemas = SchemasOf(kBegin + members + kEnd);
  INFO((schemas ? "" : schemas.error().text));
  REQUIRE(schemas);
  return schemas->at("demo/msg/A");
}

TEST_CASE("Types are written as ROS writes them", "[operator][bag]") {
  for (const auto& [idl, ros] : std::vector<std::pair<std::string, std::string>>{
           {"boolean x", "bool x"},
           {"octet x", "uint8 x"},
           {"int8 x", "int8 x"},
           {"short x", "int16 x"},
           {"unsigned short x", "uint16 x"},
           {"long x", "int32 x"},
           {"unsigned long x", "uint32 x"},
           {"long long x", "int64 x"},
           {"unsigned long long x", "uint64 x"},
           {"float x", "float32 x"},
           {"double x", "float64 x"},
           {"string x", "string x"},
           {"double x[36]", "float64[36] x"},
           {"sequence<octet> x", "uint8[] x"},
           {"Cell x", "demo/Cell x"},
           {"demo::msg::Cell x", "demo/Cell x"},
           {"sequence<Cell> x", "demo/Cell[] x"},
           {"Cell x[2]", "demo/Cell[2] x"},
       }) {
    const std::string text = TextOf("struct Cell { long row; }; struct A { " + idl + "; };");
    CHECK(text.substr(0, text.find('\n')) == ros);
  }
}

TEST_CASE("A definition holds its type and all that it is made of, each once", "[operator][bag]") {
  CHECK(TextOf("struct P { double x; }; struct Q { P p; }; }; };\n" + kBegin +
               "struct A { sequence<demo::msg::Q> tour; demo::msg::P ends[2];  // m\n};") ==
        "demo/Q[] tour\ndemo/P[2] ends  # m\n" +   //
            kLine + "\nMSG: demo/Q\ndemo/P p\n" +  //
            kLine + "\nMSG: demo/P\nfloat64 x\n");
}

TEST_CASE("Comments belong to the struct below and the field before them", "[operator][bag]") {
  CHECK(TextOf("  // far away\n\n  // what it is,\n  // in two lines\n"
               "  struct A {\n    long row;  // from the north\n    long column;\n  };  // behind\n"
               "  struct B { long row; };\n") ==
        "# what it is,\n# in two lines\nint32 row  # from the north\nint32 column\n");
}

TEST_CASE("A field that names constants has them before it, once in a message", "[operator][bag]") {
  CHECK(TextOf("struct A { octet kind;  // KIND_*\n octet other;  // KIND_TWO or OTHER_ONE\n"
               " long far; // KIND_*\n};\n"
               "module A_Constants { const octet KIND_ONE = 1;  // first\n"
               "const octet KIND_TWO = 2; const octet OTHER_ONE = -3;\n"
               "const octet OTHER_TWO = 4; };") ==
        "uint8 KIND_ONE=1  # first\nuint8 KIND_TWO=2\nuint8 kind  # KIND_*\n"
        "uint8 OTHER_ONE=-3\nuint8 other  # KIND_TWO or OTHER_ONE\nint32 far  # KIND_*\n");
}

TEST_CASE("A line that is not understood is refused by its number", "[operator][bag]") {
  for (const auto& [idl, line] : std::vector<std::pair<std::string, std::string>>{
           {kBegin + "enum A { B };" + kEnd, "line 3: "},
           {kBegin + "struct A {\n Wall x; };" + kEnd, "line 4: "},
           {kBegin + "struct A { long x }" + kEnd, "line 3: "},
           {kBegin + "struct A { long x[2][3]; };" + kEnd, "line 3: "},
           {kBegin + "struct A { sequence<long, 5> x; };" + kEnd, "line 3: "},
           {kBegin + "@key long x;" + kEnd, "line 3: "},
           {kBegin + "const octet X = 1;" + kEnd, "line 3: "},
           {kBegin + "module A_Constants { long x; };" + kEnd, "line 3: "},
           {"module a { module srv {", "line 1: "},
       }) {
    CAPTURE(idl);
    const auto schemas = SchemasOf(idl);
    REQUIRE_FALSE(schemas);
    CHECK(schemas.error().code == ErrorCode::kMalformed);
    CHECK_THAT(schemas.error().text, Catch::StartsWith(line));
  }
}

TEST_CASE("A text cut off anywhere is refused, not followed beyond its end", "[operator][bag]") {
  const std::string text = kBegin +
                           "// about\nstruct A { sequence<string> x; octet y[3]; // y\n };" +
                           "module A_Constants { const long long B = 1; };}; };";
  for (std::size_t size = text.find("module") + 1; size < text.size(); ++size) {
    CAPTURE(size);
    CHECK_FALSE(SchemasOf(text.substr(0, size)));
  }
  CHECK(SchemasOf(text));
}

TEST_CASE("Every constant of idl/ is in a definition", "[operator][bag]") {
  std::string all;
  for (const auto& [type, text] : ConavSchemas()) all += text;
  const std::string idl = kIdlText;
  const std::regex constant(R"(const [a-z0-9 ]+ ([A-Z_0-9]+ = [^;]+);)");
  int constants = 0;
  for (std::sregex_iterator found(idl.begin(), idl.end(), constant), end; found != end; ++found) {
    ++constants;
    const std::string text = std::regex_replace(found->str(1), std::regex(" = "), "=");
    CHECK_THAT(all, Catch::Contains(" " + text));
  }
  CHECK(constants > 20);
}

}  // namespace
}  // namespace conav::bag
