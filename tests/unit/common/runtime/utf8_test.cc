#include <catch2/catch.hpp>

#include "common/runtime/text.h"

namespace conav {
namespace {

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
