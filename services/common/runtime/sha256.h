#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace conav {

/// SHA-256 (FIPS 180-4) of bytes that arrive in parts.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  void Update(std::span<const std::byte> bytes);
  void Update(std::string_view text) { Update(std::as_bytes(std::span(text))); }
  /// The digest of all bytes so far as 64 lower-case hexadecimal digits. Call once, last.
  std::string Hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// SHA-256 of `text`, 64 lower-case hexadecimal digits.
std::string Sha256Hex(std::string_view text);

}  // namespace conav
