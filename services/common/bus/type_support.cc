#include "common/bus/type_support.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>
#include <vector>

#include "common/bus/services.h"
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

namespace {

constexpr std::size_t kClientSize = 8;
constexpr std::size_t kRequestHeaderSize = kClientSize + sizeof(RequestId::number);

/// Writing has the order of this machine, as the messages.
static_assert(std::endian::native == std::endian::little);

}  // namespace

std::size_t PayloadSize(const TypeSupport& type, const void* message) {
  const std::size_t size = type.serialized_size(message);
  return type.request_id == nullptr ? size : size + kRequestHeaderSize;
}

std::size_t ToPayload(const TypeSupport& type, const void* message,
                      std::span<std::uint8_t> payload) {
  if (type.request_id == nullptr) return type.serialize(message, payload);
  if (payload.size() < kEncapsulationSize + kRequestHeaderSize) return 0;
  // The header is as long as the largest alignment asks, so the message may be moved by it.
  const std::size_t written = type.serialize(message, payload.subspan(kRequestHeaderSize));
  if (written == 0) return 0;
  std::copy_n(payload.begin() + kRequestHeaderSize, kEncapsulationSize, payload.begin());
  const RequestId& id = type.request_id(const_cast<void*>(message));
  std::copy_n(id.client.begin(), kClientSize, payload.begin() + kEncapsulationSize);
  std::memcpy(payload.data() + kEncapsulationSize + kClientSize, &id.number, sizeof id.number);
  return written + kRequestHeaderSize;
}

bool FromPayload(const TypeSupport& type, std::span<const std::uint8_t> payload, void* message) {
  if (type.request_id == nullptr) return type.deserialize(payload, message);
  if (payload.size() < kEncapsulationSize + kRequestHeaderSize) return false;
  const bool is_big_endian = payload[1] == 0;
  std::array<std::uint8_t, kRequestHeaderSize> header;
  std::copy_n(payload.begin() + kEncapsulationSize, header.size(), header.begin());
  if (is_big_endian) {
    std::reverse(header.begin(), header.begin() + kClientSize);
    std::reverse(header.begin() + kClientSize, header.end());
  }
  std::vector<std::uint8_t> body(payload.begin() + kRequestHeaderSize, payload.end());
  std::copy_n(payload.begin(), kEncapsulationSize, body.begin());
  if (!type.deserialize(body, message)) return false;
  RequestId& id = type.request_id(message);
  id.client.fill(0);
  std::copy_n(header.begin(), kClientSize, id.client.begin());
  std::memcpy(&id.number, header.data() + kClientSize, sizeof id.number);
  return true;
}

namespace internal {

void InstantiateForServices(void (*use)(const TypeSupport& (*)())) {
  ForEachService([use](const auto& service) {
    using Service = std::decay_t<decltype(service)>;
    use(&TypeSupportOf<Envelope<typename Service::Request>>);
    use(&TypeSupportOf<Envelope<typename Service::Response>>);
  });
  ForEachAction([use](const auto& action) {
    using Types = typename std::decay_t<decltype(action)>::Types;
    use(&TypeSupportOf<Envelope<typename Types::SendGoalRequest>>);
    use(&TypeSupportOf<Envelope<typename Types::SendGoalResponse>>);
    use(&TypeSupportOf<Envelope<typename Types::GetResultRequest>>);
    use(&TypeSupportOf<Envelope<typename Types::GetResultResponse>>);
    use(&TypeSupportOf<typename Types::FeedbackMessage>);
  });
  use(&TypeSupportOf<Envelope<action_msgs::srv::CancelGoal_Request>>);
  use(&TypeSupportOf<Envelope<action_msgs::srv::CancelGoal_Response>>);
  use(&TypeSupportOf<action_msgs::msg::GoalStatusArray>);
}

/// Never called: taking the address instantiates TypeSupportOf for the type of each topic.
void InstantiateForTopics(void (*use)(const TypeSupport& (*)())) {
  const auto instantiate = [use](const auto& topic) {
    use(&TypeSupportOf<typename std::decay_t<decltype(topic)>::Type>);
  };
  ForEachRobotTopic(instantiate);
  ForEachWorldTopic(instantiate);
  ForEachSystemTopic(instantiate);
  InstantiateForServices(use);
}

}  // namespace internal

}  // namespace conav::bus
