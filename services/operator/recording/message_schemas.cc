#include "operator/recording/message_schemas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "operator/recording/idl_text.h"

namespace conav::bag {
namespace {

struct IdlToken {
  enum class Kind { kWord, kSign, kComment, kEnd };
  Kind kind;
  std::string_view text;  // of a comment what is behind the slashes; of a word also "a::b", "-1.5"
  int line;               // from 1
};

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

/// Words, single signs and `//` comments; the last one is kEnd. Lines that begin with '#' are left
/// out. The tokens refer to `text`.
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

using Kind = IdlToken::Kind;

const std::map<std::string, std::string>& BasicTypes() {
  static const std::map<std::string, std::string> types{
      {"boolean", "bool"},
      {"octet", "uint8"},
      {"char", "char"},
      {"int8", "int8"},
      {"uint8", "uint8"},
      {"short", "int16"},
      {"int16", "int16"},
      {"uint16", "uint16"},
      {"long", "int32"},
      {"int32", "int32"},
      {"uint32", "uint32"},
      {"long long", "int64"},
      {"int64", "int64"},
      {"uint64", "uint64"},
      {"float", "float32"},
      {"double", "float64"},
      {"string", "string"},
      {"unsigned short", "uint16"},
      {"unsigned long", "uint32"},
      {"unsigned long long", "uint64"},
  };
  return types;
}

/// Recursive descent. After the first error every token looks like the end, so that all loops do.
class Parser {
 public:
  explicit Parser(std::string_view text) : tokens_(TokenizeIdl(text)) {}

  Result<IdlDocument> Run() {
    while (!failure_ && Peek().kind != Kind::kEnd) ParseModule();
    if (failure_) return Fail(ErrorCode::kMalformed, *failure_);
    return std::move(document_);
  }

 private:
  // Modules and their members

  void ParseModule() {
    Expect("module");
    package_ = ExpectWord();
    Expect("{");
    Expect("module");
    Expect("msg");
    Expect("{");
    while (!failure_ && !At("}")) ParseMember();
    for (const char* sign : {"}", ";", "}", ";"}) Expect(sign);
  }

  void ParseMember() {
    if (At("struct")) {
      ParseStruct();
    } else if (At("const")) {
      ParseConstant();
    } else {
      Refuse("struct, const or }");
    }
  }

  void ParseStruct() {
    IdlStruct parsed{package_, "", comment_above_, {}};
    Expect("struct");
    parsed.name = ExpectWord();
    Expect("{");
    while (!failure_ && !At("}")) parsed.fields.push_back(ParseField());
    Expect("}");
    Expect(";");
    if (!failure_) document_.structs.push_back(std::move(parsed));
  }

  void ParseConstant() {
    Expect("const");
    IdlConstant parsed{package_, ParseType(), ExpectWord(), "", ""};
    Expect("=");
    parsed.value = ExpectWord();
    parsed.comment = ExpectSemicolon();
    if (!failure_) document_.constants.push_back(std::move(parsed));
  }

  IdlField ParseField() {
    IdlField field;
    field.type = ParseType();
    field.name = ExpectWord();
    if (At("[")) {
      Expect("[");
      field.type += fmt::format("[{}]", ExpectWord());
      Expect("]");
    }
    field.comment = ExpectSemicolon();
    return field;
  }

  // Types

  std::string ParseType() {
    const std::string word = ExpectWord();
    if (word == "sequence") return ParseSequence();
    std::string basic = word;
    while (basic == "unsigned" || ((basic == "long" || basic == "unsigned long") && At("long"))) {
      basic.append(" ").append(ExpectWord());
    }
    if (basic == "string" && At("<")) return fmt::format("string<={}", ParseBound());
    const auto known = BasicTypes().find(basic);
    return known != BasicTypes().end() ? known->second : StructNamed(word);
  }

  std::string ParseSequence() {
    Expect("<");
    const std::string element = ParseType();
    if (!At(",")) {
      Expect(">");
      return element + "[]";
    }
    Expect(",");
    const std::string bound = ExpectWord();
    Expect(">");
    return fmt::format("{}[<={}]", element, bound);
  }

  std::string ParseBound() {
    Expect("<");
    const std::string bound = ExpectWord();
    Expect(">");
    return bound;
  }

  /// "Cell" or "std_msgs::msg::Header" as "conav_msgs/Cell", "std_msgs/Header".
  std::string StructNamed(const std::string& word) {
    const auto scope = word.find("::msg::");
    const std::string package = scope == std::string::npos ? package_ : word.substr(0, scope);
    const std::string name = scope == std::string::npos ? word : word.substr(scope + 7);
    const bool known =
        std::any_of(document_.structs.begin(), document_.structs.end(),
                    [&](const IdlStruct& s) { return s.package == package && s.name == name; });
    if (!known && !failure_) {
      failure_ = fmt::format("line {}: type '{}' is not known", line_, word);
    }
    return package + "/" + name;
  }

  // Tokens

  /// The next token that is no comment; comments right above it are kept.
  const IdlToken& Peek() {
    if (failure_) return tokens_.back();
    while (tokens_[next_].kind == Kind::kComment) {
      const IdlToken& comment = tokens_[next_++];
      if (comment.line != comment_line_ + 1) comment_above_.clear();
      comment_above_.emplace_back(comment.text);
      comment_line_ = comment.line;
    }
    if (tokens_[next_].line > comment_line_ + 1) comment_above_.clear();
    return tokens_[next_];
  }

  const IdlToken& Take() {
    const IdlToken& token = Peek();
    line_ = token.line;
    if (token.kind != Kind::kEnd) ++next_;
    return token;
  }

  bool At(std::string_view text) { return Peek().kind != Kind::kEnd && Peek().text == text; }

  void Expect(std::string_view text) {
    if (At(text)) {
      Take();
    } else {
      Refuse(text);
    }
  }

  std::string ExpectWord() {
    if (Peek().kind == Kind::kWord) return std::string(Take().text);
    Refuse("a name");
    return "";
  }

  /// The comment behind it on its line.
  std::string ExpectSemicolon() {
    Expect(";");
    if (failure_) return "";
    const IdlToken& next = tokens_[next_];
    if (next.kind != Kind::kComment || next.line != line_) return "";
    ++next_;
    return std::string(next.text);
  }

  void Refuse(std::string_view expected) {
    if (failure_) return;
    const IdlToken& token = Peek();
    failure_ = fmt::format("line {}: '{}' instead of {}", token.line, token.text, expected);
  }

  std::vector<IdlToken> tokens_;
  std::size_t next_ = 0;
  int line_ = 0;  // of the token taken last
  std::string package_;
  std::vector<std::string> comment_above_;
  int comment_line_ = -1;
  IdlDocument document_;
  std::optional<std::string> failure_;
};

}  // namespace

Result<IdlDocument> ParseIdl(std::string_view text) { return Parser(text).Run(); }

namespace {

std::string FullName(const IdlStruct& type) { return type.package + "/msg/" + type.name; }

/// The words of a comment that may be names of constants, or their begin with '*' behind it.
std::vector<std::string> CapitalWords(const std::string& comment) {
  std::vector<std::string> words(1);
  for (const char c : comment) {
    const bool part = std::isupper(static_cast<unsigned char>(c)) != 0 ||
                      std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '*';
    if (part) words.back() += c;
    if (!part && !words.back().empty()) words.emplace_back();
  }
  return words;
}

bool IsNamedBy(const std::string& constant, const std::string& word) {
  if (word.ends_with("_*")) return constant.starts_with(word.substr(0, word.size() - 1));
  return constant == word;
}

std::string CommentBehind(const std::string& comment) {
  return comment.empty() ? "\n" : "  # " + comment + "\n";
}

}  // namespace

MessageSchemas::MessageSchemas(IdlDocument idl) : idl_(std::move(idl)) {}

const IdlStruct* MessageSchemas::Find(const std::string& package_and_name) const {
  const auto found = std::find_if(
      idl_.structs.begin(), idl_.structs.end(),
      [&](const IdlStruct& type) { return type.package + "/" + type.name == package_and_name; });
  return found == idl_.structs.end() ? nullptr : &*found;
}

void MessageSchemas::AppendFields(const IdlStruct& type, std::string& text) const {
  for (const std::string& line : type.comment) text += "# " + line + "\n";
  std::set<std::string> written;
  for (const IdlField& field : type.fields) {
    const auto words = CapitalWords(field.comment);
    for (const IdlConstant& constant : idl_.constants) {
      const bool named = std::any_of(words.begin(), words.end(), [&](const std::string& word) {
        return IsNamedBy(constant.name, word);
      });
      if (!named || constant.package != type.package || constant.type != field.type) continue;
      if (!written.insert(constant.name).second) continue;
      text += constant.type + " " + constant.name + "=" + constant.value +
              CommentBehind(constant.comment);
    }
    text += field.type + " " + field.name + CommentBehind(field.comment);
  }
}

void MessageSchemas::AppendDependencies(const IdlStruct& type,
                                        std::vector<const IdlStruct*>& all) const {
  for (const IdlField& field : type.fields) {
    const IdlStruct* used = Find(field.type.substr(0, field.type.find('[')));
    if (used == nullptr || std::find(all.begin(), all.end(), used) != all.end()) continue;
    all.push_back(used);
    AppendDependencies(*used, all);
  }
}

Result<std::string> MessageSchemas::TextOf(const std::string& type) const {
  const auto found = std::find_if(idl_.structs.begin(), idl_.structs.end(),
                                  [&](const IdlStruct& s) { return FullName(s) == type; });
  if (found == idl_.structs.end()) {
    return Fail(ErrorCode::kNotFound, type + ": no message type of idl/");
  }
  std::string text;
  AppendFields(*found, text);
  std::vector<const IdlStruct*> dependencies;
  AppendDependencies(*found, dependencies);
  for (const IdlStruct* dependency : dependencies) {
    text += std::string(80, '=') + "\nMSG: " + dependency->package + "/" + dependency->name + "\n";
    AppendFields(*dependency, text);
  }
  return text;
}

std::vector<std::string> MessageSchemas::types() const {
  std::vector<std::string> names;
  for (const IdlStruct& type : idl_.structs) names.push_back(FullName(type));
  return names;
}

const MessageSchemas& ConavSchemas() {
  static const MessageSchemas schemas = [] {
    auto idl = ParseIdl(kIdlText);
    DEMAND(idl.has_value(), idl.error().text);
    return MessageSchemas(*std::move(idl));
  }();
  return schemas;
}

}  // namespace conav::bag
