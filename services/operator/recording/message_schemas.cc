#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "operator/recording/idl_text.h"
#include "operator/recording/mcap_file.h"

namespace conav::bag {
namespace {

struct IdlField {
  std::string type;  // as ROS writes it: "uint8[]", "float64[36]", "std_msgs/Header"
  std::string name;
  std::string comment;  // behind it on its line
};

struct IdlStruct {
  std::string package;
  std::string name;
  std::vector<std::string> comment;  // the lines above it
  std::vector<IdlField> fields;
};

struct IdlConstant {
  std::string package;
  std::string type;
  std::string name;
  std::string value;
  std::string comment;
};

struct IdlDocument {
  std::vector<IdlStruct> structs;
  std::vector<IdlConstant> constants;
};

bool IsSpace(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && IsSpace(text.front())) text.remove_prefix(1);
  while (!text.empty() && IsSpace(text.back())) text.remove_suffix(1);
  return text;
}

/// "unsigned long x" as "unsigned long" and "x".
std::pair<std::string_view, std::string> SplitName(std::string_view declaration) {
  const std::size_t space = declaration.find_last_of(" \t");
  if (space == std::string_view::npos) return {{}, std::string(declaration)};
  return {Trimmed(declaration.substr(0, space)), std::string(declaration.substr(space + 1))};
}

bool IsName(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  });
}

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

/// Takes the text line by line, and a line's code statement by statement, each up to one of "{};".
class Parser {
 public:
  Result<IdlDocument> Run(std::string_view text) {
    int number = 0;
    while (!text.empty()) {
      const std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(text.size(), line.size() + 1));
      ++number;
      if (line.starts_with('#') || TakeLine(line)) continue;
      return Fail(ErrorCode::kMalformed,
                  fmt::format("line {}: '{}' is not understood", number, Trimmed(line)));
    }
    if (depth_ == 0 && !closed_ && Trimmed(statement_).empty()) return std::move(document_);
    return Fail(ErrorCode::kMalformed, fmt::format("line {}: the end is missing", number));
  }

 private:
  bool TakeLine(std::string_view line) {
    const std::size_t slashes = line.find("//");
    const std::string_view code = line.substr(0, slashes);
    commented_ = nullptr;
    for (const char c : code) {
      if (c != '{' && c != '}' && c != ';') {
        statement_ += c;
      } else if (!Take(std::exchange(statement_, ""), c)) {
        return false;
      }
    }
    statement_ += ' ';
    const bool is_comment = slashes != std::string_view::npos;
    if (!is_comment || !Trimmed(code).empty()) comment_above_.clear();
    if (!is_comment) return true;
    const std::string comment(Trimmed(line.substr(slashes + 2)));
    if (Trimmed(code).empty()) comment_above_.push_back(comment);
    if (commented_ != nullptr) *commented_ = comment;
    return true;
  }

  bool Take(const std::string& text, char sign) {
    const std::string_view statement = Trimmed(text);
    commented_ = nullptr;
    if (sign == ';' && statement.empty()) return std::exchange(closed_, false);
    if (closed_ || (sign == '}' && (!statement.empty() || depth_ == 0))) return false;
    if (sign == '{') return Open(statement);
    if (sign == ';') return in_constants_ ? TakeConstant(statement) : TakeField(statement);
    --depth_;
    in_constants_ = false;
    closed_ = true;
    return true;
  }

  bool Open(std::string_view statement) {
    const auto [kind, name] = SplitName(statement);
    const bool constants = depth_ == 2 && kind == "module" && name.ends_with("_Constants");
    if (!IsName(name) || (kind != (depth_ < 2 ? "module" : "struct") && !constants)) return false;
    if (depth_ == 1 ? name != "msg" : depth_ > 2) return false;
    if (depth_ == 0) package_ = name;
    in_constants_ = constants;
    if (depth_ == 2 && !constants) {
      document_.structs.push_back({package_, name, comment_above_, {}});
    }
    ++depth_;
    return true;
  }

  bool TakeField(std::string_view statement) {
    if (depth_ != 3) return false;
    const auto [type, declared] = SplitName(statement);
    const std::string name = declared.substr(0, declared.find('['));
    const std::string size = declared.substr(name.size());  // "[36]" or nothing
    const std::string ros_type = RosType(type);
    const bool good =
        size.empty() || (size.ends_with(']') && IsName({size.data() + 1, size.size() - 2}));
    if (!good || !IsName(name) || ros_type.empty()) return false;
    std::vector<IdlField>& fields = document_.structs.back().fields;
    fields.push_back({ros_type + size, name, ""});
    commented_ = &fields.back().comment;
    return true;
  }

  bool TakeConstant(std::string_view statement) {
    const std::size_t equals = statement.find('=');
    if (!statement.starts_with("const ") || equals == std::string_view::npos) {
      return false;
    }
    const auto [type, name] = SplitName(Trimmed(statement.substr(6, equals - 6)));
    const std::string value(Trimmed(statement.substr(equals + 1)));
    document_.constants.push_back({package_, RosType(type), name, value, ""});
    commented_ = &document_.constants.back().comment;
    return IsName(name) && !value.empty() && !document_.constants.back().type.empty();
  }

  /// "sequence<Cell>" as "conav_msgs/Cell[]"; empty for a type that is not known.
  std::string RosType(std::string_view type) const {
    constexpr std::string_view kSequence = "sequence<";
    if (type.starts_with(kSequence) && type.ends_with('>')) {
      type.remove_prefix(kSequence.size());
      type.remove_suffix(1);
      const std::string element = RosType(Trimmed(type));
      return element.empty() ? "" : element + "[]";
    }
    const auto known = BasicTypes().find(std::string(type));
    if (known != BasicTypes().end()) return known->second;
    const std::size_t scope = type.find("::msg::");
    const bool own = scope == std::string_view::npos;
    const std::string_view package = own ? package_ : type.substr(0, scope);
    const std::string_view name = own ? type : type.substr(scope + 7);
    const bool defined = std::ranges::any_of(document_.structs, [&](const IdlStruct& s) {
      return s.package == package && s.name == name;
    });
    return defined ? fmt::format("{}/{}", package, name) : "";
  }

  int depth_ = 0;              // of braces
  bool in_constants_ = false;  // in a module of constants
  bool closed_ = false;        // by the brace before, whose semicolon has to follow
  std::string statement_;
  std::string package_;
  std::vector<std::string> comment_above_;
  std::string* commented_ = nullptr;  // of the field or constant before, on this line
  IdlDocument document_;
};

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

/// The definitions of all structs.
class Definitions {
 public:
  explicit Definitions(IdlDocument idl) : idl_(std::move(idl)) {}

  MessageSchemas All() const {
    MessageSchemas all;
    for (const IdlStruct& type : idl_.structs) {
      all[type.package + "/msg/" + type.name] = TextOf(type);
    }
    return all;
  }

 private:
  std::string TextOf(const IdlStruct& type) const {
    std::string text;
    AppendFields(type, text);
    std::vector<const IdlStruct*> dependencies;
    AppendDependencies(type, dependencies);
    for (const IdlStruct* used : dependencies) {
      text += std::string(80, '=') + "\nMSG: " + used->package + "/" + used->name + "\n";
      AppendFields(*used, text);
    }
    return text;
  }

  void AppendFields(const IdlStruct& type, std::string& text) const {
    for (const std::string& line : type.comment) text += "# " + line + "\n";
    std::set<std::string> written;
    for (const IdlField& field : type.fields) {
      const auto words = CapitalWords(field.comment);
      for (const IdlConstant& constant : idl_.constants) {
        const bool named = std::ranges::any_of(
            words, [&](const std::string& word) { return IsNamedBy(constant.name, word); });
        if (!named || constant.package != type.package || constant.type != field.type) continue;
        if (!written.insert(constant.name).second) continue;
        text += constant.type + " " + constant.name + "=" + constant.value +
                CommentBehind(constant.comment);
      }
      text += field.type + " " + field.name + CommentBehind(field.comment);
    }
  }

  void AppendDependencies(const IdlStruct& type, std::vector<const IdlStruct*>& all) const {
    for (const IdlField& field : type.fields) {
      const std::string name = field.type.substr(0, field.type.find('['));
      const auto used = std::ranges::find_if(idl_.structs, [&](const IdlStruct& candidate) {
        return candidate.package + "/" + candidate.name == name;
      });
      if (used == idl_.structs.end() || std::ranges::find(all, &*used) != all.end()) continue;
      all.push_back(&*used);
      AppendDependencies(*used, all);
    }
  }

  IdlDocument idl_;
};

}  // namespace

Result<MessageSchemas> SchemasOf(std::string_view idl) {
  return Parser().Run(idl).map(
      [](IdlDocument&& document) { return Definitions(std::move(document)).All(); });
}

const MessageSchemas& ConavSchemas() {
  static const MessageSchemas schemas = [] {
    auto all = SchemasOf(kIdlText);
    DEMAND(all.has_value(), all.error().text);
    return *std::move(all);
  }();
  return schemas;
}

}  // namespace conav::bag
