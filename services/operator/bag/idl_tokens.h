#pragma once

#include <string_view>
#include <vector>

namespace conav::bag {

struct IdlToken {
  enum class Kind { kWord, kSign, kComment, kEnd };
  Kind kind;
  std::string_view text;  // of a comment what is behind the slashes; of a word also "a::b", "-1.5"
  int line;               // from 1
};

/// Words, single signs and `//` comments; the last one is kEnd. Lines that begin with '#' are left
/// out. The tokens refer to `text`.
std::vector<IdlToken> TokenizeIdl(std::string_view text);

}  // namespace conav::bag
