#include <catch2/catch.hpp>
#include <string>

#include "operator/recording/message_schemas.h"

namespace conav::bag {
namespace {

constexpr const char* kBegin = "#include \"x.idl\"\nmodule demo { module msg {\n";
constexpr const char* kEnd = "\n}; };\n";

IdlDocument Parsed(const std::string& members) {
  auto document = ParseIdl(kBegin + members + kEnd);
  INFO((document ? "" : document.error().text));
  REQUIRE(document);
  return *document;
}

std::string ErrorOf(const std::string& members) {
  const auto document = ParseIdl(kBegin + members + kEnd);
  REQUIRE_FALSE(document);
  CHECK(document.error().code == ErrorCode::kMalformed);
  return document.error().text;
}

std::string TypeOf(const std::string& idl) {
  const auto document = Parsed("struct Cell { long row; }; struct A { " + idl + " };");
  return document.structs.at(1).fields.at(0).type;
}

TEST_CASE("Structs have package, name and fields in order", "[operator][bag]") {
  const auto document = Parsed("struct A { long row; double width; }; struct B { A a; };");
  REQUIRE(document.structs.size() == 2);
  CHECK(document.structs[0].package == "demo");
  CHECK(document.structs[0].name == "A");
  REQUIRE(document.structs[0].fields.size() == 2);
  CHECK(document.structs[0].fields[1].name == "width");
  CHECK(document.structs[1].fields[0].type == "demo/A");
}

TEST_CASE("Types are written as ROS writes them", "[operator][bag]") {
  CHECK(TypeOf("boolean x;") == "bool");
  CHECK(TypeOf("octet x;") == "uint8");
  CHECK(TypeOf("int8 x;") == "int8");
  CHECK(TypeOf("short x;") == "int16");
  CHECK(TypeOf("unsigned short x;") == "uint16");
  CHECK(TypeOf("long x;") == "int32");
  CHECK(TypeOf("unsigned long x;") == "uint32");
  CHECK(TypeOf("long long x;") == "int64");
  CHECK(TypeOf("unsigned long long x;") == "uint64");
  CHECK(TypeOf("float x;") == "float32");
  CHECK(TypeOf("double x;") == "float64");
  CHECK(TypeOf("string x;") == "string");
  CHECK(TypeOf("string<8> x;") == "string<=8");
  CHECK(TypeOf("double x[36];") == "float64[36]");
  CHECK(TypeOf("sequence<octet> x;") == "uint8[]");
  CHECK(TypeOf("sequence<unsigned long, 5> x;") == "uint32[<=5]");
  CHECK(TypeOf("Cell x;") == "demo/Cell");
  CHECK(TypeOf("demo::msg::Cell x;") == "demo/Cell");
  CHECK(TypeOf("sequence<Cell> x;") == "demo/Cell[]");
  CHECK(TypeOf("Cell x[2];") == "demo/Cell[2]");
}

TEST_CASE("Comments belong to the struct below and the field before them", "[operator][bag]") {
  const auto document = Parsed(
      "  // far away\n\n  // what it is,\n  // in two lines\n"
      "  struct A {\n    long row;  // from the north\n    long column;\n  };\n"
      "  struct B { long row; };  // behind\n");
  CHECK(document.structs[0].comment == std::vector<std::string>{"what it is,", "in two lines"});
  CHECK(document.structs[0].fields[0].comment == "from the north");
  CHECK(document.structs[0].fields[1].comment.empty());
  CHECK(document.structs[1].comment.empty());
}

TEST_CASE("Constants have type, value and comment", "[operator][bag]") {
  const auto document = Parsed("const octet KIND_A = 3;  // three\nconst long LOW = -1;");
  REQUIRE(document.constants.size() == 2);
  CHECK(document.constants[0].package == "demo");
  CHECK(document.constants[0].type == "uint8");
  CHECK(document.constants[0].name == "KIND_A");
  CHECK(document.constants[0].value == "3");
  CHECK(document.constants[0].comment == "three");
  CHECK(document.constants[1].value == "-1");
}

TEST_CASE("What is not understood is refused by its line", "[operator][bag]") {
  CHECK(ErrorOf("enum A { B };") == "line 3: 'enum' instead of struct, const or }");
  CHECK(ErrorOf("struct A {\n Wall x; };") == "line 4: type 'Wall' is not known");
  CHECK(ErrorOf("struct A { long x }") == "line 3: '}' instead of ;");
  CHECK(ErrorOf("struct A { long x[2][3]; };") == "line 3: '[' instead of ;");
  CHECK(ErrorOf("@key long x;") == "line 3: '@' instead of struct, const or }");
  CHECK(ParseIdl("module a { module srv {").error().text == "line 1: 'srv' instead of msg");
  CHECK(ParseIdl("module a { module msg {").error().text ==
        "line 1: 'the end' instead of struct, const or }");
}

TEST_CASE("A text cut off anywhere is refused, not followed beyond its end", "[operator][bag]") {
  const std::string text =
      std::string(kBegin) +
      "// about\nstruct A { sequence<string<8>, 4> x[3]; // y\n }; const long long B = 1;" +
      "}; };";
  for (std::size_t size = text.find("module") + 1; size < text.size(); ++size) {
    CAPTURE(size);
    CHECK_FALSE(ParseIdl(text.substr(0, size)));
  }
  CHECK(ParseIdl(text));
}

}  // namespace
}  // namespace conav::bag
