#include "common/runtime/text.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

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

TEST_CASE("SHA-256 gives the digests of FIPS 180-4's examples", "[runtime][sha256]") {
  CHECK(Sha256Hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(Sha256Hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(Sha256Hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST_CASE("SHA-256 does not depend on how the bytes are parted", "[runtime][sha256]") {
  const std::string text(1000, 'x');
  Sha256 digest;
  for (std::size_t at = 0; at < text.size(); at += 37) digest.Update(text.substr(at, 37));
  CHECK(digest.Hex() == Sha256Hex(text));
}

TEST_CASE("Characters of one to four bytes are UTF-8", "[runtime][utf8]") {
  CHECK(IsUtf8(""));
  CHECK(IsUtf8("plain"));
  CHECK(IsUtf8("\xC3\xA9 \xE2\x82\xAC \xF0\x9F\xA4\x96"));
}

TEST_CASE("Other encodings, cut, overlong and surrogate characters are not UTF-8",
          "[runtime][utf8]") {
  CHECK_FALSE(IsUtf8("caf\xE9"));
  CHECK_FALSE(IsUtf8("\xE2\x82"));
  CHECK_FALSE(IsUtf8("\xC0\xAF"));
  CHECK_FALSE(IsUtf8("\xE0\x80\xAF"));
  CHECK_FALSE(IsUtf8("\xED\xA0\x80"));
  CHECK_FALSE(IsUtf8("\xF4\x90\x80\x80"));
}

TEST_CASE("What is not UTF-8 is made readable", "[runtime][utf8]") {
  CHECK(Readable("wall ahead, \xC3\xBC") == "wall ahead, \xC3\xBC");
  CHECK(Readable("bad \xFF\x01 byte") == "bad ?\x01 byte");
}

}  // namespace
}  // namespace conav
