#include <catch2/catch.hpp>

#include "common/runtime/config.h"
#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

TEST_CASE("a YAML file is read, whatever its document is made of", "[runtime][yaml]") {
  const test::TemporaryFolder folder;
  const auto read = [&](const std::string& text) {
    REQUIRE(WriteFile(folder / "a.yaml", text));
    return ReadYamlFile(folder / "a.yaml").value();
  };
  CHECK(read("a: {b: 3}")["a"]["b"].as<int>() == 3);
  CHECK(read("hello").IsScalar());
  CHECK(read("[1, 2]").IsSequence());
  CHECK(read("").IsNull());
}

TEST_CASE("a YAML file that is missing, a folder or malformed is named", "[runtime][yaml]") {
  const test::TemporaryFolder folder;
  CHECK(ReadYamlFile("/none.yaml").error().text == "/none.yaml: no such file");
  const auto of_folder = ReadYamlFile(folder.path());
  REQUIRE_FALSE(of_folder);
  CHECK(of_folder.error().text == folder.path().string() + ": cannot read: Is a directory");
  REQUIRE(WriteFile(folder / "a.yaml", "a: [1"));
  const auto malformed = ReadYamlFile(folder / "a.yaml");
  REQUIRE_FALSE(malformed);
  CHECK(malformed.error().code == ErrorCode::kMalformed);
  CHECK_THAT(malformed.error().text,
             Catch::StartsWith((folder / "a.yaml").string() + ": not valid YAML: "));
}

}  // namespace
}  // namespace conav
