#include "operator/bag/message_schemas.h"

#include <algorithm>
#include <cctype>
#include <set>
#include <utility>

#include "common/runtime/demand.h"
#include "operator/bag/idl_text.h"

namespace conav::bag {
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
