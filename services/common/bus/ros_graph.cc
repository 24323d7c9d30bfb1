#include "common/bus/ros_graph.h"

#include <algorithm>
#include <cctype>

#include "common/bus/type_support_of.h"
#include "common/runtime/log.h"
#include "ros2_graph.h"

namespace conav::bus {

// ros_discovery_info has two layouts under one DDS name.
template <>
const TypeSupport& TypeSupportOf<ros_graph_jazzy::msg::ParticipantEntitiesInfo>() {
  static const TypeSupport support = MakeTypeSupport<ros_graph_jazzy::msg::ParticipantEntitiesInfo>(
      "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
  return support;
}

template <>
const TypeSupport& TypeSupportOf<ros_graph_humble::msg::ParticipantEntitiesInfo>() {
  static const TypeSupport support =
      MakeTypeSupport<ros_graph_humble::msg::ParticipantEntitiesInfo>(
          "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_");
  return support;
}

namespace {

using JazzyInfo = ros_graph_jazzy::msg::ParticipantEntitiesInfo;
using HumbleInfo = ros_graph_humble::msg::ParticipantEntitiesInfo;

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

}  // namespace

std::string RosName(std::string name) {
  const auto odd = [](unsigned char c) { return std::isalnum(c) == 0; };
  std::replace_if(name.begin(), name.end(), odd, '_');
  return name;
}

RosGraph::RosGraph(const std::string& node_name, const std::string& distribution,
                   const Guid& participant)
    : node_name_(RosName(node_name)),
      humble_(distribution == "humble"),
      participant_(participant) {}

EndpointOptions RosGraph::endpoint() const {
  return {"ros_discovery_info", humble_ ? TypeSupportOf<HumbleInfo>() : TypeSupportOf<JazzyInfo>(),
          kLatchedQos};
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
  PublishLocked();
}

void RosGraph::PublishLocked() {
  Result<void> result;
  if (humble_) {
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
