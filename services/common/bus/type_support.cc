#include "common/bus/type_support.h"

#include <type_traits>

#include "common/bus/topics.h"
#include "common/bus/type_support_of.h"

namespace conav::bus {

std::string RosTypeName(std::string_view cpp_name) {
  const auto separator = cpp_name.rfind("::");
  if (separator == std::string_view::npos) return "dds_::" + std::string(cpp_name) + "_";
  const auto after = separator + 2;
  return std::string(cpp_name.substr(0, after))
      .append("dds_::")
      .append(cpp_name.substr(after))
      .append("_");
}

namespace internal {

/// Never called: taking the address instantiates TypeSupportOf for the type of each topic.
void InstantiateForTopics(void (*use)(const TypeSupport& (*)())) {
  const auto instantiate = [use](const auto& topic) {
    use(&TypeSupportOf<typename std::decay_t<decltype(topic)>::Type>);
  };
  ForEachRobotTopic(instantiate);
  ForEachWorldTopic(instantiate);
  ForEachSystemTopic(instantiate);
}

}  // namespace internal

}  // namespace conav::bus
