#include "common/runtime/sha256.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>

#include "common/runtime/demand.h"

namespace conav {

struct Sha256::Context {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> value{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  const int started = EVP_DigestInit_ex(context_->value.get(), EVP_sha256(), nullptr);
  DEMAND(started == 1, started);
}

Sha256::~Sha256() = default;

void Sha256::Update(std::span<const std::byte> bytes) {
  const int updated = EVP_DigestUpdate(context_->value.get(), bytes.data(), bytes.size());
  DEMAND(updated == 1, updated);
}

std::string Sha256::Hex() {
  std::array<unsigned char, 32> digest{};
  const int finished = EVP_DigestFinal_ex(context_->value.get(), digest.data(), nullptr);
  DEMAND(finished == 1, finished);
  return fmt::format("{:02x}", fmt::join(digest, ""));
}

std::string Sha256Hex(std::string_view text) {
  Sha256 digest;
  digest.Update(text);
  return digest.Hex();
}

}  // namespace conav
