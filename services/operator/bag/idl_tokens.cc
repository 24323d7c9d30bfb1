#include "operator/bag/idl_tokens.h"

#include <algorithm>
#include <cctype>

namespace conav::bag {
namespace {

bool IsSpace(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

bool IsWordPart(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' || c == '.' ||
         c == '-';
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsSpace(text.back())) text.remove_suffix(1);
  return text;
}

void TokenizeLine(std::string_view line, int number, std::vector<IdlToken>& tokens) {
  using Kind = IdlToken::Kind;
  while (!(line = Trimmed(line)).empty()) {
    if (line.starts_with("//")) {
      tokens.push_back({Kind::kComment, Trimmed(line.substr(2)), number});
      return;
    }
    const auto end = std::find_if_not(line.begin(), line.end(), IsWordPart);
    const auto length = static_cast<std::size_t>(end - line.begin());
    tokens.push_back({length > 0 ? Kind::kWord : Kind::kSign,
                      line.substr(0, std::max<std::size_t>(length, 1)), number});
    line.remove_prefix(tokens.back().text.size());
  }
}

}  // namespace

std::vector<IdlToken> TokenizeIdl(std::string_view text) {
  std::vector<IdlToken> tokens;
  int number = 0;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    ++number;
    if (!line.starts_with('#')) TokenizeLine(line, number, tokens);
  }
  tokens.push_back({IdlToken::Kind::kEnd, "the end", number});
  return tokens;
}

}  // namespace conav::bag
