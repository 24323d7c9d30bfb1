#include "common/runtime/text.h"

#include <fmt/core.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <random>

#include "common/runtime/file.h"

namespace conav {
namespace {

/// Number of bytes that follow the first byte of a character; -1 if `first` begins none.
int FollowingBytes(unsigned char first) {
  if (first < 0x80) return 0;
  if (first >= 0xC2 && first < 0xE0) return 1;
  if (first >= 0xE0 && first < 0xF0) return 2;
  if (first >= 0xF0 && first < 0xF5) return 3;
  return -1;
}

}  // namespace

bool IsUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i++]);
    const int following = FollowingBytes(first);
    if (following < 0) return false;
    for (int k = 0; k < following; ++k, ++i) {
      if (i == text.size()) return false;
      const auto byte = static_cast<unsigned char>(text[i]);
      int low = 0x80;
      int high = 0xBF;
      if (k == 0 && first == 0xE0) low = 0xA0;
      if (k == 0 && first == 0xED) high = 0x9F;
      if (k == 0 && first == 0xF0) low = 0x90;
      if (k == 0 && first == 0xF4) high = 0x8F;
      if (byte < low || byte > high) return false;
    }
  }
  return true;
}

std::string Readable(std::string_view text) {
  std::string readable(text);
  if (IsUtf8(text)) return readable;
  std::replace_if(
      readable.begin(), readable.end(), [](char c) { return static_cast<unsigned char>(c) > 0x7F; },
      '?');
  return readable;
}

bool IsPlainName(std::string_view text) {
  const auto is_plain = [](char c) {
    return c != '/' && c != '\x7F' && static_cast<unsigned char>(c) >= 0x20;
  };
  return IsUtf8(text) && std::ranges::all_of(text, is_plain);
}

std::string UtcTime(std::time_t time, const char* format) {
  std::tm utc{};
  gmtime_r(&time, &utc);
  std::array<char, 64> text{};
  return {text.data(), std::strftime(text.data(), text.size(), format, &utc)};
}

std::string UniqueId() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  return fmt::format("{:012x}-{:08x}", ms, std::random_device()());
}

std::string JsonText(const nlohmann::ordered_json& document) {
  constexpr auto kReplace = nlohmann::ordered_json::error_handler_t::replace;
  return document.dump(2, ' ', false, kReplace) + "\n";
}

Result<void> WriteJsonFile(const std::filesystem::path& path,
                           const nlohmann::ordered_json& document) {
  return WriteDurableFile(path, JsonText(document));
}

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
  return Join(digest, "", "{:02x}");
}

std::string Sha256Hex(std::string_view text) {
  Sha256 digest;
  digest.Update(text);
  return digest.Hex();
}

}  // namespace conav
