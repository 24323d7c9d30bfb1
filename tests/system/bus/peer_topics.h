#pragma once

#include "common/bus/topics.h"
#include "ros2_graph.h"
#include "support/test_messages.h"

/// What bus_peer and the tests talk over.
namespace conav::test {

using conav_test::msg::Blob;
using conav_test::msg::KeyedBlob;

inline constexpr bus::Topic<Blob> kPing{"/test/ping", bus::kDefaultQos};
inline constexpr bus::Topic<Blob> kPong{"/test/pong", bus::kDefaultQos};
inline constexpr bus::Topic<KeyedBlob> kKeyedPing{"/test/keyed_ping", bus::kDefaultQos};
inline constexpr bus::Topic<KeyedBlob> kKeyedPong{"/test/keyed_pong", bus::kDefaultQos};

/// The peer counts how many of the ids 1, 2, ... came in order, and reports that as id when a
/// message without data ends the flood.
inline constexpr bus::Topic<Blob> kFlood{"/test/flood", bus::kRequestQos};
inline constexpr bus::Topic<Blob> kFloodReport{"/test/flood_report", bus::kLatchedQos};

/// The peer publishes ids 1 to kHistoryPublished at its start.
inline constexpr std::uint64_t kHistoryPublished = 12;
inline constexpr int kHistoryDepth = 5;
inline constexpr bus::Topic<Blob> kHistory{
    "/test/history",
    {bus::Reliability::kReliable, bus::Durability::kTransientLocal, kHistoryDepth}};

/// The peer publishes three payloads that are no Blob and then the Blob with id 1.
inline constexpr int kGarbagePublished = 3;
inline constexpr bus::Qos kGarbageQos{bus::Reliability::kReliable, bus::Durability::kTransientLocal,
                                      kGarbagePublished};
inline constexpr bus::Topic<RawBlob> kGarbage{"/test/garbage", kGarbageQos};
inline constexpr bus::Topic<Blob> kAfterGarbage{"/test/garbage", kGarbageQos};

/// The peer offers best effort on one and requests reliable on the other.
inline constexpr bus::Topic<Blob> kBestEffortOffer{"/test/offer", bus::kSensorQos};
inline constexpr bus::Topic<Blob> kReliableRequest{"/test/request", bus::kDefaultQos};

/// Offered by a peer on Cyclone DDS.
inline constexpr bus::Topic<Blob> kShortLease{"/test/short_lease", bus::kDefaultQos};

template <class Info>
inline constexpr bus::Topic<Info> kRosGraph{
    "ros_discovery_info", {bus::Reliability::kReliable, bus::Durability::kTransientLocal, 0}};

}  // namespace conav::test
