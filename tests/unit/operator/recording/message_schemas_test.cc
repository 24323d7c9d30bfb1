#include "operator/recording/message_schemas.h"

#include <catch2/catch.hpp>

#include "operator/recording/idl_text.h"

namespace conav::bag {
namespace {

MessageSchemas SchemasOf(const std::string& idl) {
  auto document = ParseIdl(idl);
  REQUIRE(document);
  return MessageSchemas(*std::move(document));
}

const std::string kLine(80, '=');

TEST_CASE("A definition holds its type and all that it is made of, each once", "[operator][bag]") {
  const auto schemas = SchemasOf(
      "module a { module msg { struct P { double x; }; struct Q { P p; }; }; };\n"
      "module b { module msg {\n"
      "// a tour\n"
      "struct R { sequence<a::msg::Q> tour; a::msg::P ends[2];  // m\n};\n"
      "}; };");
  const auto text = schemas.TextOf("b/msg/R");
  REQUIRE(text);
  CHECK(*text == "# a tour\na/Q[] tour\na/P[2] ends  # m\n" +  //
                     kLine + "\nMSG: a/Q\na/P p\n" +           //
                     kLine + "\nMSG: a/P\nfloat64 x\n");
}

TEST_CASE("A field that names constants has them before it, once in a message", "[operator][bag]") {
  const auto schemas = SchemasOf(
      "module a { module msg {\n"
      "struct A { octet kind;  // KIND_*\n octet other;  // KIND_TWO or OTHER_ONE\n long far; // "
      "KIND_*\n};\n"
      "const octet KIND_ONE = 1;  // first\n"
      "const octet KIND_TWO = 2;\n"
      "const octet OTHER_ONE = 3;\n"
      "const octet OTHER_TWO = 4;\n"
      "}; };");
  CHECK(schemas.TextOf("a/msg/A").value() ==
        "uint8 KIND_ONE=1  # first\nuint8 KIND_TWO=2\nuint8 kind  # KIND_*\n"
        "uint8 OTHER_ONE=3\nuint8 other  # KIND_TWO or OTHER_ONE\nint32 far  # KIND_*\n");
}

TEST_CASE("An unknown type has no definition", "[operator][bag]") {
  const auto text = ConavSchemas().TextOf("conav_msgs/msg/Nothing");
  REQUIRE_FALSE(text);
  CHECK(text.error().code == ErrorCode::kNotFound);
}

TEST_CASE("A robot's state has its names, constants and types of ROS", "[operator][bag]") {
  const std::string text = ConavSchemas().TextOf("conav_msgs/msg/RobotState").value();
  CHECK_THAT(text, Catch::StartsWith("# /<robot>/state, sim -> all"));
  CHECK_THAT(text, Catch::Contains("\nstd_msgs/Header header\n"));
  CHECK_THAT(text, Catch::Contains("\nconav_msgs/Cell[] goals_left  #"));
  CHECK_THAT(text, Catch::Contains("\nuint8 COMMAND_OUTCOME_BLOCKED=3"));
  CHECK_THAT(text, Catch::Contains("\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"));
}

TEST_CASE("Every type of idl/ has a definition, and every constant is in one", "[operator][bag]") {
  std::string all;
  for (const std::string& type : ConavSchemas().types()) {
    const auto text = ConavSchemas().TextOf(type);
    REQUIRE(text);
    CHECK_FALSE(text->empty());
    all += *text;
  }
  const auto idl = ParseIdl(kIdlText);
  REQUIRE(idl);
  REQUIRE(idl->constants.size() > 20);
  for (const IdlConstant& constant : idl->constants) {
    CHECK_THAT(all, Catch::Contains(constant.type + " " + constant.name + "=" + constant.value));
  }
}

}  // namespace
}  // namespace conav::bag
