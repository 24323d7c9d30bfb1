// The ROS graph that a process publishes, against what discovery itself shows: Cyclone's built-in
// topics.
#include <dds/dds.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <functional>
#include <set>

#include "common/bus/intake.h"
#include "common/bus/ros_graph.h"
#include "common/bus/subscriber.h"
#include "system/bus/peer_process.h"
#include "system/bus/peer_topics.h"

namespace conav::test {
namespace {

using bus::Guid;

bus::ParticipantOptions Options(const std::string& vendor, const std::string& distribution) {
  bus::ParticipantOptions options = OnLoopback(vendor);
  options.ros_distribution = FindNamed(bus::kRosDistributions, distribution);
  return options;
}

Guid ToGuid(const dds_guid_t& key) {
  Guid guid;
  std::memcpy(guid.data(), key.v, guid.size());
  return guid;
}

/// The first 16 bytes of a gid; the layout of humble has 8 zeros behind them.
template <class Gid>
Guid ToGuid(const Gid& gid) {
  Guid guid;
  const auto rest = gid.data().begin() + guid.size();
  std::copy(gid.data().begin(), rest, guid.begin());
  CHECK(std::all_of(rest, gid.data().end(), [](std::uint8_t byte) { return byte == 0; }));
  return guid;
}

template <class Gid>
std::set<Guid> ToGuids(const std::vector<Gid>& gids) {
  std::set<Guid> guids;
  for (const Gid& gid : gids) guids.insert(ToGuid(gid));
  CHECK(guids.size() == gids.size());
  return guids;
}

/// A participant on Cyclone DDS whose built-in topics are read.
class Discovery {
 public:
  explicit Discovery(const std::string& distribution)
      : participant_("discovery", Options("cyclonedds", distribution)) {
    REQUIRE(dds_lookup_participant(static_cast<dds_domainid_t>(TestDomain()), &handle_, 1) >= 1);
  }

  /// Endpoints of the published ROS graph.
  std::set<Guid> WritersOf(const Guid& owner) const {
    return Endpoints(DDS_BUILTIN_TOPIC_DCPSPUBLICATION, owner);
  }
  std::set<Guid> ReadersOf(const Guid& owner) const {
    return Endpoints(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION, owner);
  }

  std::string UserDataOf(const Guid& participant) const {
    std::string text;
    ForEach(DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, [&](const void* sample) {
      const auto& found = *static_cast<const dds_builtintopic_participant_t*>(sample);
      void* data = nullptr;
      std::size_t size = 0;
      if (ToGuid(found.key) != participant || !dds_qget_userdata(found.qos, &data, &size)) return;
      text.assign(static_cast<const char*>(data), size);
      dds_free(data);
    });
    return text;
  }

 private:
  std::set<Guid> Endpoints(dds_entity_t topic, const Guid& owner) const {
    std::set<Guid> guids;
    ForEach(topic, [&](const void* sample) {
      const auto& found = *static_cast<const dds_builtintopic_endpoint_t*>(sample);
      const bool listed = std::strcmp(found.topic_name, "ros_discovery_info") != 0;
      if (listed && ToGuid(found.participant_key) == owner) guids.insert(ToGuid(found.key));
    });
    return guids;
  }

  void ForEach(dds_entity_t topic, const std::function<void(const void*)>& visit) const {
    constexpr int kMaximum = 256;
    const dds_entity_t reader = dds_create_reader(handle_, topic, nullptr, nullptr);
    REQUIRE(reader > 0);
    void* samples[kMaximum] = {};
    dds_sample_info_t infos[kMaximum];
    const int count = dds_read(reader, samples, infos, kMaximum, kMaximum);
    for (int i = 0; i < count; ++i) {
      if (infos[i].valid_data) visit(samples[i]);
    }
    if (count > 0) dds_return_loan(reader, samples, count);
    dds_delete(reader);
  }

  bus::Participant participant_;
  dds_entity_t handle_ = 0;
};

/// `Info`: ros_discovery_info in the layout of `distribution`.
template <class Info>
void CheckGraph(const std::string& distribution) {
  const std::string here = GENERATE("cyclonedds", "fastdds");
  const std::string there = GENERATE("cyclonedds", "fastdds");
  CAPTURE(distribution, here, there);
  const PeerProcess peer(there, distribution);
  const Discovery discovery(distribution);
  bus::Participant participant("bus_test", Options(here, distribution));
  bus::Subscriber<Info> graph(participant, kRosGraph<Info>);

  Info info;
  const auto is_of_peer = [](const Info& any) {
    return any.node_entities_info_seq().at(0).node_name() == "bus_peer";
  };
  const auto is_complete = [&] {
    for (const Info& any : graph.Take()) {
      if (is_of_peer(any)) info = any;
    }
    if (info.node_entities_info_seq().empty()) return false;
    const auto& node = info.node_entities_info_seq()[0];
    return node.writer_gid_seq().size() == 6 && node.reader_gid_seq().size() == 4 &&
           discovery.WritersOf(ToGuid(info.gid())).size() == 6 &&
           discovery.ReadersOf(ToGuid(info.gid())).size() == 4;
  };
  REQUIRE(WaitUntil(participant, is_complete));
  const auto& node = info.node_entities_info_seq()[0];
  CHECK(node.node_namespace() == "/");
  CHECK(ToGuids(node.writer_gid_seq()) == discovery.WritersOf(ToGuid(info.gid())));
  CHECK(ToGuids(node.reader_gid_seq()) == discovery.ReadersOf(ToGuid(info.gid())));
  CHECK(discovery.UserDataOf(ToGuid(info.gid())) == "enclave=/;");
}

TEST_CASE("ROS 2 tools of jazzy learn the peer's node and its endpoints", "[system][bus]") {
  CheckGraph<ros_graph_jazzy::msg::ParticipantEntitiesInfo>("jazzy");
}

TEST_CASE("ROS 2 tools of humble learn the peer's node and its endpoints", "[system][bus]") {
  CheckGraph<ros_graph_humble::msg::ParticipantEntitiesInfo>("humble");
}

TEST_CASE("a process that knows no distribution publishes no graph", "[system][bus]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  CAPTURE(vendor);
  const PeerProcess silent(vendor, "none");
  const PeerProcess known(vendor, "humble");
  bus::Participant participant("bus_test", Options(vendor, "none"));
  bus::Subscriber<bus::RosDiscoveryInfo> graph(participant, bus::kRosDiscoveryInfo);
  bus::Subscriber<Blob> echoes(participant, kPong);
  // Both processes are found; only one shows its two participants.
  REQUIRE(WaitUntil(participant, [&] {
    return echoes.matched_publishers() == 2 && graph.matched_publishers() == 2;
  }));
  REQUIRE(WaitUntil(participant, [&] {
    for (const auto& info : graph.Take()) {
      const auto nodes = bus::ParseRosDiscoveryInfo(info);
      REQUIRE(nodes);
      CHECK(nodes->layout == bus::RosDistribution::kHumble);
      if (nodes->names == std::vector<std::string>{"/bus_peer"}) return true;
    }
    return false;
  }));
}

}  // namespace
}  // namespace conav::test
