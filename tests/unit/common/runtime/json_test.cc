#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/runtime/text.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

namespace fs = std::filesystem;

using Folder = test::TemporaryFolder;

std::string TextOf(const fs::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("bytes that are no text are replaced", "[runtime][json]") {
  CHECK(JsonText({{"file", "d\xff"}}) == "{\n  \"file\": \"d\xEF\xBF\xBD\"\n}\n");
}

TEST_CASE("a document is written with its keys in order and a final newline", "[runtime][json]") {
  const Folder folder;
  const fs::path file = folder.path() / "a.json";
  REQUIRE(WriteJsonFile(file, {{"zebra", 1}, {"ant", "two"}}));
  CHECK(TextOf(file) == "{\n  \"zebra\": 1,\n  \"ant\": \"two\"\n}\n");
}

TEST_CASE("a second write replaces the first and leaves nothing beside it", "[runtime][json]") {
  const Folder folder;
  const fs::path file = folder.path() / "a.json";
  REQUIRE(WriteJsonFile(file, {{"a", 1}}));
  REQUIRE(WriteJsonFile(file, {{"a", 2}}));
  CHECK(nlohmann::json::parse(TextOf(file))["a"] == 2);
  CHECK(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()) == 1);
}

TEST_CASE("a file that cannot be written is named", "[runtime][json]") {
  const auto result = WriteJsonFile("/nonexistent/folder/a.json", {{"a", 1}});
  REQUIRE_FALSE(result);
  CHECK(result.error().code == ErrorCode::kIo);
  CHECK_THAT(result.error().text, Catch::StartsWith("/nonexistent/folder/a.json: cannot write"));
}

TEST_CASE("a full disk is told, and a device stays what it is", "[runtime][json]") {
  const auto result = WriteJsonFile("/dev/full", {{"a", 1}});
  REQUIRE_FALSE(result);
  CHECK_THAT(result.error().text, Catch::Contains("No space left"));
  CHECK(fs::is_character_file("/dev/full"));
}

}  // namespace conav
