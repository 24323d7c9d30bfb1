#include "common/bus/ros_graph.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>

#include "common/bus/type_support_of.h"
#include "common/runtime/log.h"
#include "ros2_graph.h"

namespace conav::bus {

using JazzyInfo = ros_graph_jazzy::msg::ParticipantEntitiesInfo;
using HumbleInfo = ros_graph_humble::msg::ParticipantEntitiesInfo;

/// One DDS name for both layouts.
constexpr const char* kTypeName = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

template <>
const TypeSupport& TypeSupportOf<JazzyInfo>() {
  static const TypeSupport support = MakeTypeSupport<JazzyInfo>(kTypeName);
  return support;
}

template <>
const TypeSupport& TypeSupportOf<HumbleInfo>() {
  static const TypeSupport support = MakeTypeSupport<HumbleInfo>(kTypeName);
  return support;
}

template <>
const TypeSupport& TypeSupportOf<RosDiscoveryInfo>() {
  static const TypeSupport support = {
      kTypeName,
      [](const void* info) { return static_cast<const RosDiscoveryInfo*>(info)->payload.size(); },
      [](const void* info, std::span<std::uint8_t> payload) {
        const auto& bytes = static_cast<const RosDiscoveryInfo*>(info)->payload;
        if (payload.size() < bytes.size()) return std::size_t{0};
        std::ranges::copy(bytes, payload.begin());
        return bytes.size();
      },
      [](std::span<const std::uint8_t> payload, void* info) {
        static_cast<RosDiscoveryInfo*>(info)->payload.assign(payload.begin(), payload.end());
        return true;
      },
      [] { return static_cast<void*>(new RosDiscoveryInfo()); },
      [](void* info) { delete static_cast<RosDiscoveryInfo*>(info); }};
  return support;
}

namespace {

constexpr std::size_t kLargestPadding = 3;  // of a payload, to a multiple of four bytes

template <class Gid>
Gid ToGid(const Guid& guid) {
  Gid gid;
  std::copy(guid.begin(), guid.end(), gid.data().begin());
  return gid;
}

template <class Gid>
std::vector<Gid> ToGids(const std::vector<Guid>& guids) {
  std::vector<Gid> gids;
  std::transform(guids.begin(), guids.end(), std::back_inserter(gids), ToGid<Gid>);
  return gids;
}

/// Names of the nodes if the payload is an `Info` and nothing more. In the other layout it may decode,
/// too: the rest of a longer gid reads as an empty list.
template <class Info>
std::optional<std::vector<std::string>> NamesIn(const std::vector<std::uint8_t>& payload) {
  const TypeSupport& support = TypeSupportOf<Info>();
  Info info;
  if (!support.deserialize(payload, &info)) return std::nullopt;
  const std::size_t size = support.serialized_size(&info);
  if (payload.size() < size || payload.size() > size + kLargestPadding) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& node : info.node_entities_info_seq()) {
    const bool root = node.node_namespace() == "/";
    names.push_back((root ? "" : node.node_namespace()) + "/" + node.node_name());
  }
  return names;
}

}  // namespace

std::optional<RosNodes> ParseRosDiscoveryInfo(const RosDiscoveryInfo& info) {
  if (auto names = NamesIn<JazzyInfo>(info.payload)) {
    return RosNodes{RosDistribution::kJazzy, *std::move(names)};
  }
  if (auto names = NamesIn<HumbleInfo>(info.payload)) {
    return RosNodes{RosDistribution::kHumble, *std::move(names)};
  }
  return std::nullopt;
}

std::string RosName(std::string name) {
  const auto odd = [](unsigned char c) { return std::isalnum(c) == 0; };
  std::replace_if(name.begin(), name.end(), odd, '_');
  return name;
}

std::string HostName() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return RosName(name);
}

RosGraph::RosGraph(const std::string& node_name, RosDistribution distribution,
                   const Guid& participant)
    : node_name_(RosName(node_name)), distribution_(distribution), participant_(participant) {}

EndpointOptions RosGraph::endpoint() const {
  const bool humble = distribution_ == RosDistribution::kHumble;
  return {std::string(kRosDiscoveryInfo.pattern),
          humble ? TypeSupportOf<HumbleInfo>() : TypeSupportOf<JazzyInfo>(), kLatchedQos};
}

void RosGraph::Start(std::unique_ptr<Writer> writer) {
  const std::lock_guard lock(mutex_);
  writer_ = std::move(writer);
  PublishLocked();
}

void RosGraph::Change(std::vector<Guid>& guids, const Guid& guid, bool add) {
  const std::lock_guard lock(mutex_);
  std::erase(guids, guid);
  if (add) guids.push_back(guid);
  if (writer_) PublishLocked();
}

void RosGraph::PublishLocked() {
  Result<void> result;
  if (distribution_ == RosDistribution::kHumble) {
    using namespace ros_graph_humble::msg;
    const auto message = MakeMessage<ParticipantEntitiesInfo, Gid, NodeEntitiesInfo>();
    result = writer_->Write(&message);
  } else {
    using namespace ros_graph_jazzy::msg;
    const auto message = MakeMessage<ParticipantEntitiesInfo, Gid, NodeEntitiesInfo>();
    result = writer_->Write(&message);
  }
  if (!result) LOG_WARNING("ros_discovery_info not sent", "reason", result.error().text);
}

template <class Message, class Gid, class Node>
Message RosGraph::MakeMessage() const {
  Node node;
  node.node_namespace("/");
  node.node_name(node_name_);
  node.reader_gid_seq(ToGids<Gid>(readers_));
  node.writer_gid_seq(ToGids<Gid>(writers_));
  Message message;
  message.gid(ToGid<Gid>(participant_));
  message.node_entities_info_seq({node});
  return message;
}

}  // namespace conav::bus
