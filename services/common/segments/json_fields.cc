#include "common/segments/json_fields.h"

#include <limits>

namespace conav {

JsonFields::JsonFields(const nlohmann::json& object, std::string name)
    : object_(object), name_(std::move(name)) {
  if (!object.is_object()) RefuseLine("{} is no object", name_.empty() ? "the line" : name_);
}

const nlohmann::json* JsonFields::Find(const char* key) {
  asked_.insert(key);
  const auto found = object_.find(key);
  return found == object_.end() || found->is_null() ? nullptr : &*found;
}

const nlohmann::json& JsonFields::Member(const char* key) {
  const nlohmann::json* member = Find(key);
  if (member == nullptr) RefuseLine("'{}{}' is missing", name_, key);
  return *member;
}

void JsonFields::Wrong(const char* key, const char* wanted) const {
  RefuseLine("'{}{}' is {}; it must be {}", name_, key, object_.at(key).dump(), wanted);
}

std::string JsonFields::Text(const char* key) {
  const nlohmann::json& member = Member(key);
  if (!member.is_string()) Wrong(key, "a text");
  return member.get<std::string>();
}

double JsonFields::Number(const char* key) {
  const nlohmann::json& member = Member(key);
  if (!member.is_number()) Wrong(key, "a number");
  return member.get<double>();
}

std::uint64_t JsonFields::Count(const char* key) {
  const nlohmann::json& member = Member(key);
  if (!member.is_number_unsigned()) Wrong(key, "a whole number from 0 on");
  return member.get<std::uint64_t>();
}

std::uint32_t JsonFields::SmallCount(const char* key) {
  const std::uint64_t count = Count(key);
  if (count > std::numeric_limits<std::uint32_t>::max()) Wrong(key, "below 2^32");
  return static_cast<std::uint32_t>(count);
}

std::string JsonFields::TextOr(const char* key, std::string otherwise) {
  return Find(key) == nullptr ? otherwise : Text(key);
}

std::uint64_t JsonFields::CountOr(const char* key, std::uint64_t otherwise) {
  return Find(key) == nullptr ? otherwise : Count(key);
}

std::optional<double> JsonFields::MaybeNumber(const char* key) {
  return Find(key) == nullptr ? std::nullopt : std::optional(Number(key));
}

std::optional<bool> JsonFields::MaybeFlag(const char* key) {
  const nlohmann::json* member = Find(key);
  if (member == nullptr) return std::nullopt;
  if (!member->is_boolean()) Wrong(key, "true or false");
  return member->get<bool>();
}

void JsonFields::RefuseOthers() const {
  for (const auto& [key, value] : object_.items()) {
    if (!asked_.contains(key)) RefuseLine("'{}{}' is not known", name_, key);
  }
}

}  // namespace conav
