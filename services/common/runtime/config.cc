#include "common/runtime/config.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/runtime/file.h"
#include "common/runtime/text.h"

namespace conav {

Result<YAML::Node> ReadYamlFile(const std::filesystem::path& file) {
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  try {
    return YAML::Load(*text);
  } catch (const YAML::Exception& error) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: not valid YAML: {}", file.string(), error.what()));
  }
}

namespace {

/// " (line 12)" of a node that was read from a file.
std::string LineOf(const YAML::Node& node) {
  return node && !node.Mark().is_null() ? fmt::format(" (line {})", node.Mark().line + 1) : "";
}

/// A YAML key may be anything, even a list.
std::string KeyText(const YAML::Node& key) {
  return key.IsScalar() ? key.Scalar() : YAML::Dump(key);
}

}  // namespace

ConfigReader::ConfigReader(const YAML::Node& node, std::string path)
    : node_(node), path_(std::move(path)) {
  if (node_ && !node_.IsNull() && !node_.IsMap()) {
    throw StartupError(fmt::format("{}: expected a mapping of parameters{}", path_, LineOf(node_)));
  }
}

void ConfigReader::Choice(const std::string& key, std::string& value,
                          const std::vector<std::string>& choices) {
  Field(key, value);
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
    Refuse(key, fmt::format("is not one of: {}", Join(choices, ", ")));
  }
  if (writing_) parameters_.back().choices = choices;
}

namespace {

/// Takes what `values` and `preset` have alike out of `values`; gives it back.
YAML::Node TakeEqual(YAML::Node& values, const YAML::Node& preset) {
  YAML::Node equal(YAML::NodeType::Map);
  YAML::Node rest(YAML::NodeType::Map);
  for (const auto& entry : values) {
    const std::string key = entry.first.Scalar();
    YAML::Node value = entry.second;
    if (value.IsMap() && preset[key].IsMap()) {
      const YAML::Node part = TakeEqual(value, preset[key]);
      if (part.size() > 0) equal[key] = part;
      if (value.size() > 0) rest[key] = value;
    } else if (YAML::Dump(value) == YAML::Dump(preset[key])) {
      equal[key] = value;
    } else {
      rest[key] = value;
    }
  }
  values = rest;
  return equal;
}

}  // namespace

void ConfigReader::MoveToPreset(const YAML::Node& preset) {
  YAML::Node values = YAML::Clone(output_);
  YAML::Node equal = TakeEqual(values, preset);
  equal.remove("preset");
  values["preset"] = output_["preset"];
  output_ = values;
  output_["from_preset"] = equal;
}

void ConfigReader::RefuseUnknownKeys() const {
  if (!node_ || !node_.IsMap()) return;
  for (const auto& entry : node_) {
    const std::string key = KeyText(entry.first);
    if (keys_.count(key) == 0) {
      throw StartupError(fmt::format("{}: unknown key '{}'; known keys: {}{}", path_, key,
                                     Join(keys_, ", "), LineOf(entry.first)));
    }
  }
}

void ConfigReader::Refuse(const std::string& key, const std::string& what) const {
  const std::string value = node_ && node_[key] ? YAML::Dump(node_[key]) : "(default)";
  const std::string line = node_ && node_[key] ? LineOf(node_[key]) : "";
  throw StartupError(fmt::format("{}.{} = {} {}{}", path_, key, value, what, line));
}

YAML::Node LoadParameters(const std::filesystem::path& file, const std::string& service) {
  const auto read = ReadYamlFile(file);
  if (!read) throw StartupError(read.error().text);
  const YAML::Node& document = *read;
  const YAML::Node section = document.IsMap() ? document[service] : YAML::Node();
  if (section && section.IsMap() && section["ros__parameters"]) return section["ros__parameters"];
  std::vector<std::string> sections;
  if (document.IsMap()) {
    for (const auto& entry : document) sections.push_back(KeyText(entry.first));
  }
  throw StartupError(fmt::format("{}: no section '{}: ros__parameters:'; sections here: {}",
                                 file.string(), service, Join(sections, ", ")));
}

namespace {

YAML::Node ChildOf(const YAML::Node& node, const std::string& key) {
  return node && node.IsMap() ? node[key] : YAML::Node();
}

bool AreEqual(const YAML::Node& one, const YAML::Node& other) {
  return one && other && YAML::Dump(one) == YAML::Dump(other);
}

void EmitWithOrigins(YAML::Emitter& output, const YAML::Node& config, const YAML::Node& defaults,
                     const ConfigOrigins& origins) {
  output << YAML::BeginMap;
  for (const auto& entry : config) {
    const std::string key = entry.first.Scalar();
    const YAML::Node& value = entry.second;
    output << YAML::Key << key << YAML::Value;
    if (key == "from_preset") {
      output << value;
    } else if (value.IsMap() && value.size() > 0) {
      EmitWithOrigins(output, value, ChildOf(defaults, key),
                      {ChildOf(origins.file, key), ChildOf(origins.read, key), origins.other});
    } else {
      output << value;
      const bool is_read =
          ChildOf(origins.file, key) && AreEqual(value, ChildOf(origins.read, key));
      if (is_read) {
        output << YAML::Comment("file");
      } else if (!AreEqual(value, ChildOf(defaults, key))) {
        output << YAML::Comment(origins.other);
      }
    }
  }
  output << YAML::EndMap;
}

}  // namespace

std::string WithOrigins(const std::string& service, const YAML::Node& config,
                        const YAML::Node& defaults, const ConfigOrigins& origins) {
  YAML::Emitter output;
  output << YAML::Comment("Values without a comment are defaults.");
  output << YAML::BeginMap << YAML::Key << service << YAML::Value << YAML::BeginMap;
  output << YAML::Key << "ros__parameters" << YAML::Value;
  EmitWithOrigins(output, config, defaults, origins);
  output << YAML::EndMap << YAML::EndMap;
  return std::string(output.c_str()) + "\n";
}

}  // namespace conav
