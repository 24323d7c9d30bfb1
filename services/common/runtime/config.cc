#include "common/runtime/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace conav {

ConfigReader::ConfigReader(const YAML::Node& node, std::string path)
    : node_(node), path_(std::move(path)) {
  if (node_ && !node_.IsNull() && !node_.IsMap()) {
    throw StartupError(fmt::format("{}: expected a mapping of parameters", path_));
  }
}

ConfigReader::ConfigReader() : writing_(true), output_(YAML::NodeType::Map) {}

void ConfigReader::Choice(const std::string& key, std::string& value,
                          const std::vector<std::string>& choices) {
  Field(key, value);
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
    Refuse(key, fmt::format("is not one of: {}", fmt::join(choices, ", ")));
  }
}

void ConfigReader::RefuseUnknownKeys() const {
  if (!node_ || !node_.IsMap()) return;
  for (const auto& entry : node_) {
    const auto key = entry.first.as<std::string>();
    if (keys_.count(key) == 0) {
      throw StartupError(
          fmt::format("{}: unknown key '{}'; known keys: {}", path_, key, fmt::join(keys_, ", ")));
    }
  }
}

void ConfigReader::Refuse(const std::string& key, const std::string& what) const {
  const std::string value = node_ && node_[key] ? YAML::Dump(node_[key]) : "(default)";
  throw StartupError(fmt::format("{}.{} = {} {}", path_, key, value, what));
}

YAML::Node LoadParameters(const std::filesystem::path& file, const std::string& service) {
  YAML::Node document;
  try {
    document = YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw StartupError(fmt::format("{}: cannot read this config file", file.string()));
  } catch (const YAML::Exception& error) {
    throw StartupError(fmt::format("{}: not valid YAML: {}", file.string(), error.what()));
  }
  if (!document.IsMap() || !document[service] || !document[service]["ros__parameters"]) {
    std::vector<std::string> sections;
    if (document.IsMap()) {
      for (const auto& entry : document) sections.push_back(entry.first.as<std::string>());
    }
    throw StartupError(fmt::format("{}: no section '{}: ros__parameters:'; sections here: {}",
                                   file.string(), service, fmt::join(sections, ", ")));
  }
  return document[service]["ros__parameters"];
}

}  // namespace conav
