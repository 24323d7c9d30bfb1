#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "common/runtime/result.h"

namespace conav {

/// Whether `text` is well-formed UTF-8 (table 3-7 of the Unicode standard), as protobuf texts and
/// JSON require.
bool IsUtf8(std::string_view text);

/// `text`; if it is not UTF-8, with `?` for each byte that is not ASCII.
std::string Readable(std::string_view text);

/// Whether `text` is UTF-8 for one line and for a file name: no slashes, no control characters.
bool IsPlainName(std::string_view text);
/// The complaint about any other text.
inline constexpr const char* kNoPlainName = "is not UTF-8 without / and control characters";

/// "a, b, c"; each part as `format` of fmt says.
template <class Parts>
std::string Join(const Parts& parts, std::string_view between, const char* format = "{}") {
  std::string text;
  bool is_first = true;
  for (const auto& part : parts) {
    if (!std::exchange(is_first, false)) text += between;
    text += fmt::vformat(format, fmt::make_format_args(part));
  }
  return text;
}

/// As `format` of strftime() says, at most 63 bytes.
std::string UtcTime(std::time_t time, const char* format);

/// Milliseconds since 1970 and 32 random bits, in hexadecimal: no other process has the same, and
/// those of later processes sort after earlier ones. For clients whose requests or replies must not
/// be taken for those of another process, or of themselves before a restart.
std::string UniqueId();

/// Indented, with a final newline. Bytes that are not UTF-8, as in some file names, become U+FFFD.
std::string JsonText(const nlohmann::ordered_json& document);

/// Writes JsonText as WriteDurableFile does. Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteJsonFile(const std::filesystem::path& path,
                                         const nlohmann::ordered_json& document);

/// SHA-256 (FIPS 180-4) of bytes that arrive in parts.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  void Update(std::span<const std::byte> bytes);
  void Update(std::string_view text) { Update(std::as_bytes(std::span(text))); }
  /// The digest of all bytes as 64 lower-case hexadecimal digits. Call once, last.
  std::string Hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// SHA-256 of `text`, 64 lower-case hexadecimal digits.
std::string Sha256Hex(std::string_view text);

}  // namespace conav
