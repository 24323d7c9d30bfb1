#pragma once

#include <string>
#include <string_view>

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

}  // namespace conav
