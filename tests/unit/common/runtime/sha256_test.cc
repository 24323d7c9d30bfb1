#include <catch2/catch.hpp>
#include <string>

#include "common/runtime/text.h"

namespace conav {
namespace {

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

}  // namespace
}  // namespace conav
