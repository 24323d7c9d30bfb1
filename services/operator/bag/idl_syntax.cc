#include "operator/bag/idl_syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "operator/bag/idl_tokens.h"

namespace conav::bag {
namespace {

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

}  // namespace conav::bag
