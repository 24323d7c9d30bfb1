#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/runtime/result.h"

/// The messages of Foxglove's WebSocket protocol, as JSON texts and as bytes. Pure.
///
/// Source: docs/spec.md of github.com/foxglove/ws-protocol, subprotocol foxglove.websocket.v1;
/// foxglove.sdk.v1 has the same messages.
namespace conav::foxglove {

inline constexpr std::array<std::string_view, 2> kSubprotocols{"foxglove.sdk.v1",
                                                               "foxglove.websocket.v1"};

struct Subscribe {
  struct Entry {
    std::uint32_t id = 0;
    std::uint32_t channel = 0;
  };
  std::vector<Entry> subscriptions;
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
/// A channel on which a client publishes.
struct ClientChannel {
  std::uint32_t id = 0;
  std::string topic;
  std::string encoding;
  std::string schema_name;
};
struct ClientAdvertise {
  std::vector<ClientChannel> channels;
};
struct ClientUnadvertise {
  std::vector<std::uint32_t> ids;
};
struct GetParameters {
  std::vector<std::string> names;  // empty = all
  std::optional<std::string> id;
};
/// Values are left out: there is none that may be set.
struct SetParameters {
  std::vector<std::string> names;
  std::optional<std::string> id;
};
struct WatchGraph {
  bool on = false;
};
struct FetchAsset {
  std::string uri;
  std::uint32_t request_id = 0;
};
struct ClientPublish {
  std::uint32_t channel = 0;
  std::string payload;
};
struct CallService {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string encoding;
  std::string payload;
};
using ClientMessage =
    std::variant<Subscribe, Unsubscribe, ClientAdvertise, ClientUnadvertise, GetParameters,
                 SetParameters, WatchGraph, FetchAsset, ClientPublish, CallService>;

/// What a client sent. Errors: kMalformed: not as the protocol wants it, or with a text longer than
/// 1 KiB where a name is expected; kNotFound: an operation that the server does not offer.
[[nodiscard]] Result<ClientMessage> ParseText(std::string_view text);
[[nodiscard]] Result<ClientMessage> ParseBinary(std::string_view bytes);

/// A topic that clients can subscribe to. Messages are CDR.
struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;    // "geometry_msgs/msg/Pose"
  std::string schema;  // ros2msg
};
struct Service {
  std::uint32_t id = 0;
  std::string name;
};

/// `session` names this run of the server.
std::string ServerInfoText(const std::string& name, const std::string& session);
std::string AdvertiseText(const std::vector<Channel>& channels);
/// All are std_srvs/srv/Trigger.
std::string AdvertiseServicesText(const std::vector<Service>& services);

enum class StatusLevel { kInfo, kWarning, kError };
/// `id`: a later status replaces the earlier one with this id; empty = none does.
std::string StatusText(StatusLevel level, const std::string& message, const std::string& id = "");
/// Values as JSON texts, by dotted name behind the node's: "/operator.console.port".
using Parameters = std::map<std::string, std::string>;
/// Those of `all` that are asked for; no names = all.
std::string ParameterValuesText(const Parameters& all, const std::vector<std::string>& names,
                                const std::optional<std::string>& id);
std::string ServiceFailureText(std::uint32_t service, std::uint32_t call,
                               const std::string& message);

/// Who publishes what, and who subscribes.
struct ConnectionGraph {
  std::map<std::string, std::set<std::string>> publishers;   // nodes, by topic
  std::map<std::string, std::set<std::string>> subscribers;  // nodes, by topic
  std::map<std::string, std::set<std::string>> providers;    // nodes, by service
  bool operator==(const ConnectionGraph&) const = default;
};
/// The whole graph: it replaces what was known of these topics and services.
std::string GraphText(const ConnectionGraph& graph);

/// A message of a channel without its payload. `time_ns`: of the server.
std::string MessageHead(std::uint32_t subscription, std::uint64_t time_ns);
std::string TimeBytes(std::uint64_t time_ns);
/// The response to a Trigger, in the encoding of the call, "json" or "cdr".
std::string TriggerResponseBytes(const CallService& call, bool success, const std::string& message);
std::string AssetBytes(std::uint32_t request_id, std::string_view asset);
std::string AssetErrorBytes(std::uint32_t request_id, std::string_view error);

/// A geometry_msgs/PoseStamped.
struct StampedPose {
  std::string frame;
  std::int32_t stamp_s = 0;
  std::uint32_t stamp_ns = 0;
  std::array<double, 3> position{};
  std::array<double, 4> orientation{0.0, 0.0, 0.0, 1.0};  // x, y, z, w
};
/// From JSON; keys that are missing keep the values above, but the position must be there. Errors:
/// kMalformed.
[[nodiscard]] Result<StampedPose> PoseFromJson(std::string_view json);

/// The text of a std_msgs/String in little-endian CDR. Errors: kMalformed.
[[nodiscard]] Result<std::string> TextFromCdr(std::string_view bytes);

}  // namespace conav::foxglove
