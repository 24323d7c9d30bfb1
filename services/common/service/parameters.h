#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/runtime/config.h"
#include "common/runtime/result.h"
#include "ros2_services.h"

// One user: node_services.cc; tests ask it without a bus.

namespace conav {

/// The configuration of a service as the parameters of a ROS 2 node (rcl_interfaces), with types,
/// ranges and choices from the configuration's struct. All are read-only but the live ones.
/// Threads: one at a time.
class Parameters {
 public:
  using Values = std::vector<std::pair<std::string, YAML::Node>>;
  /// Takes over all of `values`, which are of the right types and in range, or none.
  using Apply = std::function<Result<void>(const Values& values)>;

  explicit Parameters(std::vector<ConfigParameter> parameters)
      : parameters_(std::move(parameters)) {}

  /// Without one, all are read-only.
  void SetApply(Apply apply) { apply_ = std::move(apply); }

  rcl_interfaces::msg::ListParametersResult List(
      const rcl_interfaces::srv::ListParameters_Request& request) const;
  /// One for each name, of type 0 (not set) if the name is not known.
  std::vector<rcl_interfaces::msg::ParameterDescriptor> Describe(
      const std::vector<std::string>& names) const;
  std::vector<rcl_interfaces::msg::ParameterValue> Get(const std::vector<std::string>& names) const;
  std::vector<std::uint8_t> Types(const std::vector<std::string>& names) const;

  /// All or none. The reason of a refusal names the parameter.
  rcl_interfaces::msg::SetParametersResult Set(
      const std::vector<rcl_interfaces::msg::Parameter>& changes);

  std::vector<rcl_interfaces::msg::Parameter> All() const;

 private:
  const ConfigParameter* Find(std::string_view name) const;
  Result<YAML::Node> Check(const rcl_interfaces::msg::Parameter& change) const;

  std::vector<ConfigParameter> parameters_;
  Apply apply_;
};

/// `values` as if they had been read from a file: nested mappings for names with dots.
void MergeInto(YAML::Node& config, const Parameters::Values& values);

}  // namespace conav
