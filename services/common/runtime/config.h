#pragma once

#include <yaml-cpp/yaml.h>

#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/runtime/named.h"
#include "common/runtime/result.h"

namespace conav {

/// Parses a YAML file; an empty file gives a null node.
/// Errors, each naming the file: those of ReadFile, kMalformed.
[[nodiscard]] Result<YAML::Node> ReadYamlFile(const std::filesystem::path& file);

/// One field of a configuration, as ROS 2 describes a parameter.
struct ConfigParameter {
  enum class Type { kBool, kInteger, kDouble, kString, kIntegers, kDoubles, kStrings, kYaml };

  std::string name;  // "search.iterations"
  Type type;         // kYaml: what ROS 2 has no type for, as a text in YAML
  YAML::Node value;
  std::optional<std::pair<double, double>> range;
  std::vector<std::string> choices;  // none = any
  bool is_live = false;              // may be set while the service runs
};

template <class T>
constexpr ConfigParameter::Type ParameterTypeOf() {
  using Type = ConfigParameter::Type;
  if constexpr (std::is_same_v<T, bool>) return Type::kBool;
  if constexpr (std::is_integral_v<T>) return Type::kInteger;
  if constexpr (std::is_floating_point_v<T>) return Type::kDouble;
  if constexpr (std::is_same_v<T, std::string>) return Type::kString;
  if constexpr (requires { typename T::value_type; }) {
    constexpr Type kElement = ParameterTypeOf<typename T::value_type>();
    if constexpr (kElement == Type::kInteger) return Type::kIntegers;
    if constexpr (kElement == Type::kDouble) return Type::kDoubles;
    if constexpr (kElement == Type::kString) return Type::kStrings;
  }
  return Type::kYaml;
}

/// Reads one service's section of a YAML file in ROS parameter style:
///
///   planner:
///     ros__parameters:
///       iterations: 1000
///       search: {exploration_constant: 1.4}
///
/// A config struct declares its fields once, with their defaults, in
///   void Visit(ConfigReader& reader) { reader.Field("iterations", iterations, 1, 100000); ... }
/// and Load() fills it. Unknown keys, wrong types and values out of range throw StartupError with
/// file, key, value and limit. The same Visit writes the effective config (Dump).
class ConfigReader {
 public:
  /// If `node` is null or undefined, all defaults stay. Messages name the section `path`.
  ConfigReader(const YAML::Node& node, std::string path);
  /// Writing mode: Field() stores the current values, which emitted() returns.
  ConfigReader() : writing_(true), output_(YAML::NodeType::Map) {}

  template <class T>
  void Field(const std::string& key, T& value) {
    keys_.insert(key);
    if (writing_) {
      output_[key] = value;
      parameters_.push_back({key, ParameterTypeOf<T>(), output_[key], {}, {}});
      return;
    }
    if (!node_ || !node_[key]) return;
    try {
      value = node_[key].as<T>();
    } catch (const YAML::Exception& error) {
      Refuse(key, "has a value of the wrong type");
    }
  }

  template <class T>
  void Field(const std::string& key, T& value, std::type_identity_t<T> low,
             std::type_identity_t<T> high) {
    Field(key, value);
    if (!(value >= low && value <= high)) {
      Refuse(key, "is out of range [" + Text(low) + ", " + Text(high) + "]");
    }
    if constexpr (std::is_arithmetic_v<T>) {
      if (writing_) parameters_.back().range.emplace(low, high);
    }
  }

  /// The last field may be set while the service runs (its Reconfigure(), service_main.h).
  void Live() {
    if (writing_) parameters_.back().is_live = true;
  }

  /// A text that must be one of `choices`.
  void Choice(const std::string& key, std::string& value, const std::vector<std::string>& choices);

  /// One of `choices`, enumerators, by its Name().
  template <class Enum, std::size_t kCount>
  void Choice(const std::string& key, Enum& value, const std::array<Enum, kCount>& choices) {
    std::string name(Name(value));
    Choice(key, name, Names(choices));
    value = *FindNamed(choices, name);
  }

  /// The same, or an empty text for none.
  template <class Enum, std::size_t kCount>
  void Choice(const std::string& key, std::optional<Enum>& value,
              const std::array<Enum, kCount>& choices) {
    std::vector<std::string> names = Names(choices);
    names.insert(names.begin(), "");
    std::string name(value ? Name(*value) : "");
    Choice(key, name, names);
    value = FindNamed(choices, name);
  }

  /// A nested struct with its own Visit.
  template <class T>
  void Section(const std::string& key, T& value) {
    keys_.insert(key);
    if (writing_) {
      ConfigReader inner;
      value.Visit(inner);
      output_[key] = inner.output_;
      for (ConfigParameter& parameter : inner.parameters_) {
        parameter.name = key + "." + parameter.name;
        parameters_.push_back(std::move(parameter));
      }
      return;
    }
    ConfigReader inner(node_ ? node_[key] : YAML::Node(), path_ + "." + key);
    value.Visit(inner);
    inner.RefuseUnknownKeys();
  }

  /// Of a section whose values a preset sets: writing puts those that `preset`, a config of the same
  /// type, has too under the key `from_preset`, which reading skips. So a dump says where each value
  /// is from, and another preset in a copy of it counts. Call at the end of Visit().
  template <class T>
  void FromPreset(T preset) {
    keys_.insert("from_preset");
    if (!writing_) return;
    ConfigReader base;
    base.is_base_ = true;
    preset.Visit(base);
    MoveToPreset(base.output_);
  }
  /// Whether this writes the base of FromPreset(), which must not ask for another.
  bool is_base() const { return is_base_; }

  /// False while writing.
  bool reading() const { return !writing_; }

  void RefuseUnknownKeys() const;
  const YAML::Node& emitted() const { return output_; }
  /// After writing: all fields, also those of sections.
  const std::vector<ConfigParameter>& parameters() const { return parameters_; }

  /// Throws StartupError "path.key = value <what>".
  [[noreturn]] void Refuse(const std::string& key, const std::string& what) const;

 private:
  template <class T>
  static std::string Text(const T& value) {
    YAML::Node node;
    node = value;
    return YAML::Dump(node);
  }

  void MoveToPreset(const YAML::Node& preset);

  bool writing_ = false;
  bool is_base_ = false;
  YAML::Node node_;
  YAML::Node output_;
  std::string path_;
  std::set<std::string> keys_;
  std::vector<ConfigParameter> parameters_;
};

/// Reads `<service>: ros__parameters:` of `file`. Throws StartupError when the file cannot be read
/// or lacks that section (the message lists its sections).
YAML::Node LoadParameters(const std::filesystem::path& file, const std::string& service);

/// Fills `config` from `node`; rejects keys that Visit does not declare.
template <class T>
void ReadConfig(const YAML::Node& node, const std::string& path, T& config) {
  ConfigReader reader(node, path);
  config.Visit(reader);
  reader.RefuseUnknownKeys();
}

/// What the values of a dump are compared with, to say in comments where they come from.
struct ConfigOrigins {
  YAML::Node file;    // the parameters of the file that was read, if any
  YAML::Node read;    // the config as it was read from there
  std::string other;  // a comment at values that are neither from the file nor defaults
};

template <class T>
YAML::Node Emitted(T config) {
  ConfigReader writer;
  config.Visit(writer);
  return writer.emitted();
}

/// All fields of `config`.
template <class T>
std::vector<ConfigParameter> ParametersOf(T config) {
  ConfigReader writer;
  config.Visit(writer);
  return writer.parameters();
}

/// `config` as YAML with those comments; `defaults` is that of a new config.
std::string WithOrigins(const std::string& service, const YAML::Node& config,
                        const YAML::Node& defaults, const ConfigOrigins& origins);

/// The effective config as a YAML document that LoadParameters can read back.
template <class T>
std::string DumpConfig(const std::string& service, T config,
                       const ConfigOrigins& origins = {{}, {}, "set"}) {
  return WithOrigins(service, Emitted(std::move(config)), Emitted(T()), origins);
}

}  // namespace conav
