#include "common/runtime/text.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

TEST_CASE("a document is written with its keys in order, bytes that are no text are replaced",
          "[json]") {
  const test::TemporaryFolder folder;
  REQUIRE(WriteJsonFile(folder / "a.json", {{"zebra", 1}, {"ant", "d\xff"}}));
  CHECK(ReadFile(folder / "a.json").value() ==
        "{\n  \"zebra\": 1,\n  \"ant\": \"d\xEF\xBF\xBD\"\n}\n");
}

TEST_CASE("two ids are never the same", "[text]") { CHECK(UniqueId() != UniqueId()); }

TEST_CASE("SHA-256 gives the digests of FIPS 180-4's examples", "[sha256]") {
  CHECK(Sha256Hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(Sha256Hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(Sha256Hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  // However the bytes are parted.
  const std::string text(1000, 'x');
  Sha256 digest;
  for (std::size_t at = 0; at < text.size(); at += 37) digest.Update(text.substr(at, 37));
  CHECK(digest.Hex() == Sha256Hex(text));
}

TEST_CASE(
    "Characters of one to four bytes are UTF-8, and cut, overlong and surrogate ones are made "
    "readable",
    "[utf8]") {
  for (const char* good :
       {"", "plain", "\xC3\xA9 \xE2\x82\xAC \xF0\x9F\xA4\x96 \xF4\x8F\xBF\xBF"}) {
    CHECK(IsUtf8(good));
  }
  for (const char* bad : {"caf\xE9", "\x80", "a\xC3", "\xC3(", "\xE2\x82", "\xC0\xAF",
                          "\xE0\x80\xAF", "\xED\xA0\x80", "\xF0\x80\x80\x80", "\xF4\x90\x80\x80"}) {
    CHECK_FALSE(IsUtf8(bad));
  }
  CHECK(Readable("wall ahead, \xC3\xBC") == "wall ahead, \xC3\xBC");
  CHECK(Readable("bad \xFF\x01 byte") == "bad ?\x01 byte");
}

}  // namespace
}  // namespace conav
