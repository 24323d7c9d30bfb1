#include "common/service/parameters.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/runtime/text.h"

namespace conav {
namespace {

using rcl_interfaces::msg::Parameter;
using rcl_interfaces::msg::ParameterDescriptor;
using rcl_interfaces::msg::ParameterValue;
using rcl_interfaces::msg::SetParametersResult;
using Type = ConfigParameter::Type;

/// rcl_interfaces/msg/ParameterType
constexpr std::uint8_t kNotSet = 0;
constexpr std::uint8_t kBool = 1;
constexpr std::uint8_t kInteger = 2;
constexpr std::uint8_t kDouble = 3;
constexpr std::uint8_t kString = 4;
constexpr std::uint8_t kIntegerArray = 7;
constexpr std::uint8_t kDoubleArray = 8;
constexpr std::uint8_t kStringArray = 9;

constexpr std::uint8_t RosType(Type type) {
  switch (type) {
    case Type::kBool:
      return kBool;
    case Type::kInteger:
      return kInteger;
    case Type::kDouble:
      return kDouble;
    case Type::kIntegers:
      return kIntegerArray;
    case Type::kDoubles:
      return kDoubleArray;
    case Type::kStrings:
      return kStringArray;
    case Type::kString:
    case Type::kYaml:
      return kString;
  }
  return kNotSet;
}

std::string_view Name(std::uint8_t ros_type) {
  constexpr std::array<std::string_view, 10> kNames{"not set",
                                                    "a bool",
                                                    "an integer",
                                                    "a double",
                                                    "a string",
                                                    "bytes",
                                                    "an array of bools",
                                                    "an array of integers",
                                                    "an array of doubles",
                                                    "an array of strings"};
  return ros_type < kNames.size() ? kNames[ros_type] : "of no known type";
}

/// Beyond what int64 holds (seeds), the largest that it does.
std::int64_t ToInteger(const YAML::Node& node) {
  std::int64_t value = std::numeric_limits<std::int64_t>::max();
  YAML::convert<std::int64_t>::decode(node, value);
  return value;
}

std::int64_t ToInteger(double bound) {
  constexpr double kLargest = 9.2e18;
  return static_cast<std::int64_t>(std::clamp(bound, -kLargest, kLargest));
}

std::string Flow(YAML::Node node) {
  YAML::Emitter text;
  text.SetSeqFormat(YAML::Flow);
  text.SetMapFormat(YAML::Flow);
  text << node;
  return text.c_str();
}

ParameterValue ValueOf(const ConfigParameter& parameter) {
  ParameterValue value;
  value.type(RosType(parameter.type));
  const YAML::Node& node = parameter.value;
  switch (parameter.type) {
    case Type::kBool:
      value.bool_value(node.as<bool>());
      break;
    case Type::kInteger:
      value.integer_value(ToInteger(node));
      break;
    case Type::kDouble:
      value.double_value(node.as<double>());
      break;
    case Type::kString:
      value.string_value(node.as<std::string>());
      break;
    case Type::kIntegers:
      for (const YAML::Node& element : node) {
        value.integer_array_value().push_back(ToInteger(element));
      }
      break;
    case Type::kDoubles:
      value.double_array_value(node.as<std::vector<double>>());
      break;
    case Type::kStrings:
      value.string_array_value(node.as<std::vector<std::string>>());
      break;
    case Type::kYaml:
      value.string_value(Flow(node));
      break;
  }
  return value;
}

ParameterDescriptor DescriptorOf(const ConfigParameter& parameter) {
  ParameterDescriptor descriptor;
  descriptor.name(parameter.name);
  descriptor.type(RosType(parameter.type));
  descriptor.read_only(!parameter.is_live);
  if (!parameter.choices.empty()) {
    descriptor.additional_constraints(fmt::format("one of: {}", Join(parameter.choices, ", ")));
  }
  if (!parameter.range) return descriptor;
  const auto [low, high] = *parameter.range;
  if (parameter.type == Type::kInteger) {
    rcl_interfaces::msg::IntegerRange range;
    range.from_value(ToInteger(low));
    range.to_value(ToInteger(high));
    range.step(1);
    descriptor.integer_range({range});
  } else {
    rcl_interfaces::msg::FloatingPointRange range;
    range.from_value(low);
    range.to_value(high);
    descriptor.floating_point_range({range});
  }
  return descriptor;
}

/// A number as a bool, integer or double of YAML; none for other types and for a double where an
/// integer is wanted.
std::optional<YAML::Node> Scalar(const ParameterValue& value, Type wanted) {
  YAML::Node node;
  if (value.type() == kBool && wanted == Type::kBool) {
    node = value.bool_value();
  } else if (value.type() == kInteger && (wanted == Type::kInteger || wanted == Type::kDouble)) {
    node = value.integer_value();
  } else if (value.type() == kDouble && wanted == Type::kDouble) {
    node = value.double_value();
  } else if (value.type() == kString && wanted == Type::kString) {
    node = value.string_value();
  } else {
    return std::nullopt;
  }
  return node;
}

}  // namespace

const ConfigParameter* Parameters::Find(std::string_view name) const {
  const auto found = std::ranges::find(parameters_, name, &ConfigParameter::name);
  return found == parameters_.end() ? nullptr : &*found;
}

rcl_interfaces::msg::ListParametersResult Parameters::List(
    const rcl_interfaces::srv::ListParameters_Request& request) const {
  const auto is_asked_for = [&](const std::string& name) {
    const auto levels_below = [&](std::size_t from) {
      return static_cast<std::uint64_t>(
          1 + std::count(name.begin() + static_cast<std::ptrdiff_t>(from), name.end(), '.'));
    };
    const auto is_near = [&](std::size_t from) {
      return request.depth() == 0 || levels_below(from) <= request.depth();
    };
    if (request.prefixes().empty()) return is_near(0);
    return std::ranges::any_of(request.prefixes(), [&](const std::string& prefix) {
      return name == prefix || (name.starts_with(prefix + ".") && is_near(prefix.size() + 1));
    });
  };
  rcl_interfaces::msg::ListParametersResult result;
  std::set<std::string> prefixes;
  for (const ConfigParameter& parameter : parameters_) {
    if (!is_asked_for(parameter.name)) continue;
    result.names().push_back(parameter.name);
    const auto dot = parameter.name.rfind('.');
    if (dot != std::string::npos) prefixes.insert(parameter.name.substr(0, dot));
  }
  result.prefixes({prefixes.begin(), prefixes.end()});
  return result;
}

std::vector<ParameterDescriptor> Parameters::Describe(const std::vector<std::string>& names) const {
  std::vector<ParameterDescriptor> descriptors;
  for (const std::string& name : names) {
    const ConfigParameter* parameter = Find(name);
    descriptors.push_back(parameter != nullptr ? DescriptorOf(*parameter) : ParameterDescriptor());
    descriptors.back().name(name);
  }
  return descriptors;
}

std::vector<ParameterValue> Parameters::Get(const std::vector<std::string>& names) const {
  std::vector<ParameterValue> values;
  for (const std::string& name : names) {
    const ConfigParameter* parameter = Find(name);
    values.push_back(parameter != nullptr ? ValueOf(*parameter) : ParameterValue());
  }
  return values;
}

std::vector<std::uint8_t> Parameters::Types(const std::vector<std::string>& names) const {
  std::vector<std::uint8_t> types;
  for (const ParameterValue& value : Get(names)) types.push_back(value.type());
  return types;
}

std::vector<Parameter> Parameters::All() const {
  std::vector<Parameter> all;
  for (const ConfigParameter& parameter : parameters_) {
    Parameter made;
    made.name(parameter.name);
    made.value(ValueOf(parameter));
    all.push_back(std::move(made));
  }
  return all;
}

Result<YAML::Node> Parameters::Check(const Parameter& change) const {
  const ConfigParameter* parameter = Find(change.name());
  const auto refuse = [&](std::string_view what) {
    return Fail(ErrorCode::kRefused, fmt::format("{} {}", change.name(), what));
  };
  if (parameter == nullptr) return refuse("is no parameter of this node");
  if (!parameter->is_live) return refuse("is read-only: it is set in the configuration file");
  if (!apply_) return refuse("cannot be set before the service runs");
  const std::optional<YAML::Node> value = Scalar(change.value(), parameter->type);
  if (!value) {
    return refuse(
        fmt::format("is {}, not {}", Name(RosType(parameter->type)), Name(change.value().type())));
  }
  if (parameter->range) {
    const double number = value->as<double>();
    const auto [low, high] = *parameter->range;
    // Also refuses what is no number.
    if (!(number >= low && number <= high)) {
      return refuse(fmt::format("= {} is out of range [{}, {}]", number, low, high));
    }
  }
  return *value;
}

SetParametersResult Parameters::Set(const std::vector<Parameter>& changes) {
  SetParametersResult result;
  Values values;
  for (const Parameter& change : changes) {
    auto value = Check(change);
    if (!value) {
      result.reason(value.error().text);
      return result;
    }
    values.emplace_back(change.name(), *std::move(value));
  }
  if (!values.empty()) {
    if (const auto applied = apply_(values); !applied) {
      result.reason(applied.error().text);
      return result;
    }
  }
  for (const auto& [name, value] : values) {
    std::ranges::find(parameters_, name, &ConfigParameter::name)->value = value;
  }
  result.successful(true);
  return result;
}

void MergeInto(YAML::Node& config, const Parameters::Values& values) {
  for (const auto& [name, value] : values) {
    YAML::Node level = config;
    std::string_view rest = name;
    for (auto dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
      level.reset(level[std::string(rest.substr(0, dot))]);
      rest.remove_prefix(dot + 1);
    }
    level[std::string(rest)] = value;
  }
}

}  // namespace conav
