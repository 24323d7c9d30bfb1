#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

namespace conav {

/// Whether `text` is well-formed UTF-8 (table 3-7 of the Unicode standard): neither protobuf's texts
/// nor JSON carry anything else.
bool IsUtf8(std::string_view text);

/// `text`; where it is not UTF-8, with `?` for each byte that is not ASCII.
std::string Readable(std::string_view text);

/// Whether `text` is UTF-8 that may stand in a line and in a file's name: without slashes and control
/// characters.
bool IsPlainName(std::string_view text);
/// What is said of a text that is none.
inline constexpr const char* kNoPlainName = "is not UTF-8 without / and control characters";

/// Indented, with a final newline. Bytes that are no UTF-8, as a file's name may have, become U+FFFD.
std::string JsonText(const nlohmann::ordered_json& document);

/// Writes JsonText to a temporary file beside `path` and renames it, so
/// that a reader sees the old file or the new one, never half of it. Errors: kIo with path and
/// cause.
[[nodiscard]] Result<void> WriteJsonFile(const std::filesystem::path& path,
                                         const nlohmann::ordered_json& document);

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
