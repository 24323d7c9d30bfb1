#include "operator/foxglove/foxglove_messages.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace conav::foxglove {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kLongestName = 1024;

enum class ServerOpcode : std::uint8_t {
  kMessage = 1,
  kTime = 2,
  kServiceResponse = 3,
  kAsset = 4
};
constexpr std::uint8_t kClientPublish = 1;
constexpr std::uint8_t kClientCall = 2;

tl::unexpected<Error> Malformed(std::string text) {
  return Fail(ErrorCode::kMalformed, std::move(text));
}

/// Reads the members of a JSON object; the first wrong one counts.
class Members {
 public:
  Members(const Json& object, std::string of) : object_(object), of_(std::move(of)) {
    if (!object.is_object()) problem_ = of_ + " is no object";
  }

  std::uint32_t Number(const char* key) {
    const Json* value = Find(key);
    if (value == nullptr || !value->is_number_unsigned() ||
        value->get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
      return Note(key, "an integer of 32 bits"), 0;
    }
    return value->get<std::uint32_t>();
  }
  std::string Name(const char* key) {
    const Json* value = Find(key);
    if (value == nullptr || !IsName(*value)) return Note(key, kName), "";
    return value->get<std::string>();
  }
  std::optional<std::string> OptionalName(const char* key) {
    if (Find(key) == nullptr) return std::nullopt;
    return Name(key);
  }
  std::vector<std::uint32_t> Numbers(const char* key) {
    std::vector<std::uint32_t> numbers;
    for (const Json& entry : List(key)) {
      if (!entry.is_number_unsigned() ||
          entry.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
        return Note(key, "a list of integers of 32 bits"), numbers;
      }
      numbers.push_back(entry.get<std::uint32_t>());
    }
    return numbers;
  }
  std::vector<std::string> Names(const char* key) {
    std::vector<std::string> names;
    for (const Json& entry : List(key)) {
      if (!IsName(entry)) return Note(key, "a list of names"), names;
      names.push_back(entry.get<std::string>());
    }
    return names;
  }
  /// Calls each(members) for the objects of a list.
  template <class Each>
  void Objects(const char* key, Each&& each) {
    for (const Json& entry : List(key)) {
      Members members(entry, fmt::format("{} of {}", key, of_));
      if (members.problem_.empty()) each(members);
      if (problem_.empty()) problem_ = members.problem_;
      if (!problem_.empty()) return;
    }
  }
  template <class Message>
  Result<ClientMessage> Done(Message message) {
    if (!problem_.empty()) return Malformed(problem_);
    return ClientMessage(std::move(message));
  }

 private:
  static constexpr const char* kName = "a text of at most 1024 bytes";

  static bool IsName(const Json& value) {
    return value.is_string() && value.get_ref<const std::string&>().size() <= kLongestName;
  }
  const Json* Find(const char* key) const {
    if (!object_.is_object()) return nullptr;
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }
  const Json& List(const char* key) {
    static const Json nothing = Json::array();
    const Json* value = Find(key);
    if (value != nullptr && value->is_array()) return *value;
    Note(key, "a list");
    return nothing;
  }
  void Note(const char* key, const char* wanted) {
    if (problem_.empty()) problem_ = fmt::format("{}: {} is not {}", of_, key, wanted);
  }

  const Json& object_;
  std::string of_;
  std::string problem_;
};

Result<ClientMessage> ParseOperation(const std::string& op, Members& members) {
  if (op == "subscribe") {
    Subscribe subscribe;
    members.Objects("subscriptions", [&](Members& entry) {
      subscribe.subscriptions.push_back({entry.Number("id"), entry.Number("channelId")});
    });
    return members.Done(std::move(subscribe));
  }
  if (op == "unsubscribe") return members.Done(Unsubscribe{members.Numbers("subscriptionIds")});
  if (op == "advertise") {
    ClientAdvertise advertise;
    members.Objects("channels", [&](Members& entry) {
      advertise.channels.push_back({entry.Number("id"), entry.Name("topic"), entry.Name("encoding"),
                                    entry.Name("schemaName")});
    });
    return members.Done(std::move(advertise));
  }
  if (op == "unadvertise") return members.Done(ClientUnadvertise{members.Numbers("channelIds")});
  if (op == "getParameters") {
    return members.Done(GetParameters{members.Names("parameterNames"), members.OptionalName("id")});
  }
  if (op == "setParameters") {
    SetParameters set;
    members.Objects("parameters", [&](Members& entry) { set.names.push_back(entry.Name("name")); });
    set.id = members.OptionalName("id");
    return members.Done(std::move(set));
  }
  if (op == "subscribeConnectionGraph") return members.Done(WatchGraph{true});
  if (op == "unsubscribeConnectionGraph") return members.Done(WatchGraph{false});
  if (op == "fetchAsset") {
    return members.Done(FetchAsset{members.Name("uri"), members.Number("requestId")});
  }
  return Fail(ErrorCode::kNotFound, fmt::format("operation '{}' is not offered here", op));
}

/// Reads bytes from the front, little-endian. Nothing is read past the end.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : rest_(bytes) {}

  std::optional<std::uint32_t> Number(std::size_t size = 4) {
    if (rest_.size() < size) return std::nullopt;
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < size; ++i) {
      number |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(rest_[i])) << (8 * i);
    }
    rest_.remove_prefix(size);
    return number;
  }
  std::optional<std::string_view> Text(std::size_t size) {
    if (rest_.size() < size) return std::nullopt;
    const std::string_view text = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return text;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

void Append(std::string& bytes, std::uint64_t number, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes.push_back(static_cast<char>(static_cast<std::uint8_t>(number >> (8 * i))));
  }
}

std::string Begin(ServerOpcode opcode) { return {static_cast<char>(opcode)}; }

/// Texts may hold bytes that are no UTF-8, such as a client's name for something.
std::string Dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<ClientMessage> ParseCall(Bytes bytes) {
  CallService call;
  const auto service = bytes.Number();
  const auto number = bytes.Number();
  const auto length = bytes.Number();
  if (!service || !number || !length) return Malformed("a service call of too few bytes");
  if (*length > kLongestName) return Malformed("a service call with an encoding that is too long");
  const auto encoding = bytes.Text(*length);
  if (!encoding) return Malformed("a service call that ends in its encoding");
  return CallService{*service, *number, std::string(*encoding), std::string(bytes.rest())};
}

}  // namespace

Result<ClientMessage> ParseText(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) return Malformed("a text that is no JSON object");
  const auto op = message.find("op");
  if (op == message.end() || !op->is_string()) return Malformed("a JSON object without op");
  std::string name = op->get<std::string>();
  if (name.size() > kLongestName) return Malformed("an op that is too long");
  Members members(message, name);
  return ParseOperation(name, members);
}

Result<ClientMessage> ParseBinary(std::string_view message) {
  Bytes bytes(message);
  const auto opcode = bytes.Number(1);
  if (!opcode) return Malformed("an empty message");
  if (*opcode == kClientCall) return ParseCall(bytes);
  if (*opcode != kClientPublish) return Malformed(fmt::format("opcode {} is unknown", *opcode));
  const auto channel = bytes.Number();
  if (!channel) return Malformed("a published message of too few bytes");
  return ClientPublish{*channel, std::string(bytes.rest())};
}

std::string ServerInfoText(const std::string& name, const std::string& session) {
  return Dump({{"op", "serverInfo"},
               {"name", name},
               {"capabilities",
                {"clientPublish", "parameters", "time", "services", "connectionGraph", "assets"}},
               {"supportedEncodings", {"cdr", "json"}},
               {"metadata", Json::object()},
               {"sessionId", session}});
}

std::string AdvertiseText(const std::vector<Channel>& channels) {
  Json list = Json::array();
  for (const Channel& channel : channels) {
    list.push_back({{"id", channel.id},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.type},
                    {"schemaEncoding", "ros2msg"},
                    {"schema", channel.schema}});
  }
  return Dump({{"op", "advertise"}, {"channels", std::move(list)}});
}

std::string AdvertiseServicesText(const std::vector<Service>& services) {
  const auto part = [](const char* name, const char* schema) {
    return Json{{"encoding", "cdr"},
                {"schemaName", name},
                {"schemaEncoding", "ros2msg"},
                {"schema", schema}};
  };
  Json list = Json::array();
  for (const Service& service : services) {
    list.push_back(
        {{"id", service.id},
         {"name", service.name},
         {"type", "std_srvs/srv/Trigger"},
         {"request", part("std_srvs/srv/Trigger_Request", "")},
         {"response", part("std_srvs/srv/Trigger_Response", "bool success\nstring message\n")}});
  }
  return Dump({{"op", "advertiseServices"}, {"services", std::move(list)}});
}

std::string StatusText(StatusLevel level, const std::string& message, const std::string& id) {
  Json status{{"op", "status"}, {"level", static_cast<int>(level)}, {"message", message}};
  if (!id.empty()) status["id"] = id;
  return Dump(status);
}

std::string ParameterValuesText(const Parameters& all, const std::vector<std::string>& names,
                                const std::optional<std::string>& id) {
  Json list = Json::array();
  const auto add = [&](const std::string& name, const std::string& value) {
    list.push_back({{"name", name}, {"value", Json::parse(value)}});
  };
  if (names.empty()) {
    for (const auto& [name, value] : all) add(name, value);
  }
  for (const std::string& name : names) {
    const auto found = all.find(name);
    if (found != all.end()) add(name, found->second);
  }
  Json message{{"op", "parameterValues"}, {"parameters", std::move(list)}};
  if (id) message["id"] = *id;
  return Dump(message);
}

std::string ServiceFailureText(std::uint32_t service, std::uint32_t call,
                               const std::string& message) {
  return Dump({{"op", "serviceCallFailure"},
               {"serviceId", service},
               {"callId", call},
               {"message", message}});
}

std::string GraphText(const ConnectionGraph& graph) {
  const auto list = [](const auto& nodes_of, const char* key) {
    Json entries = Json::array();
    for (const auto& [name, nodes] : nodes_of) entries.push_back({{"name", name}, {key, nodes}});
    return entries;
  };
  return Dump({{"op", "connectionGraphUpdate"},
               {"publishedTopics", list(graph.publishers, "publisherIds")},
               {"subscribedTopics", list(graph.subscribers, "subscriberIds")},
               {"advertisedServices", list(graph.providers, "providerIds")},
               {"removedTopics", Json::array()},
               {"removedServices", Json::array()}});
}

std::string MessageHead(std::uint32_t subscription, std::uint64_t time_ns) {
  std::string bytes = Begin(ServerOpcode::kMessage);
  Append(bytes, subscription, 4);
  Append(bytes, time_ns, 8);
  return bytes;
}

std::string TimeBytes(std::uint64_t time_ns) {
  std::string bytes = Begin(ServerOpcode::kTime);
  Append(bytes, time_ns, 8);
  return bytes;
}

std::string TriggerResponseBytes(const CallService& call, bool success,
                                 const std::string& message) {
  std::string bytes = Begin(ServerOpcode::kServiceResponse);
  Append(bytes, call.service, 4);
  Append(bytes, call.call, 4);
  Append(bytes, call.encoding.size(), 4);
  bytes += call.encoding;
  if (call.encoding == "json") return bytes + Dump({{"success", success}, {"message", message}});
  bytes += std::string("\0\1\0\0", 4);  // little-endian CDR
  Append(bytes, success ? 1 : 0, 4);    // one byte, and three to the length
  Append(bytes, message.size() + 1, 4);
  return bytes + message + '\0';
}

std::string AssetBytes(std::uint32_t request_id, std::string_view asset) {
  std::string bytes = Begin(ServerOpcode::kAsset);
  Append(bytes, request_id, 4);
  Append(bytes, 0, 1);
  Append(bytes, 0, 4);
  return bytes.append(asset);
}

std::string AssetErrorBytes(std::uint32_t request_id, std::string_view error) {
  std::string bytes = Begin(ServerOpcode::kAsset);
  Append(bytes, request_id, 4);
  Append(bytes, 1, 1);
  Append(bytes, error.size(), 4);
  return bytes.append(error);
}

namespace {

/// Of `object`, numbers under `keys`, in this order. False for anything but finite numbers; a key
/// that is missing leaves its number.
template <std::size_t kCount>
bool ReadNumbers(const Json& object, const std::array<const char*, kCount>& keys,
                 std::array<double, kCount>& numbers) {
  if (!object.is_object()) return false;
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto found = object.find(keys[i]);
    if (found == object.end()) continue;
    const Json& value = *found;
    if (!value.is_number() || !std::isfinite(value.get<double>())) return false;
    numbers[i] = value.get<double>();
  }
  return true;
}

/// The member, or null.
Json Member(const Json& object, const char* key) {
  return object.is_object() ? object.value(key, Json()) : Json();
}

}  // namespace

Result<StampedPose> PoseFromJson(std::string_view text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object()) return Malformed("a PoseStamped that is no JSON object");
  StampedPose pose;
  const Json header = Member(message, "header");
  const Json frame = Member(header, "frame_id");
  if (frame.is_string()) pose.frame = frame.get<std::string>();
  if (!frame.is_string() && !frame.is_null()) return Malformed("header.frame_id is no text");
  const Json stamp = Member(header, "stamp");
  std::array<double, 3> time{};
  if (!stamp.is_null()) {
    if (!ReadNumbers<3>(stamp, {"sec", "nsec", "nanosec"}, time) || time[0] < 0.0 ||
        time[0] > std::numeric_limits<std::int32_t>::max() || time[1] < 0.0 || time[1] >= 1e9 ||
        time[2] < 0.0 || time[2] >= 1e9) {
      return Malformed("header.stamp is no time");
    }
    pose.stamp_s = static_cast<std::int32_t>(time[0]);
    pose.stamp_ns = static_cast<std::uint32_t>(std::max(time[1], time[2]));
  }
  const Json inner = Member(message, "pose");
  if (!ReadNumbers<3>(Member(inner, "position"), {"x", "y", "z"}, pose.position)) {
    return Malformed("pose.position is not {x, y, z} of finite numbers");
  }
  const Json orientation = Member(inner, "orientation");
  if (!orientation.is_null() &&
      !ReadNumbers<4>(orientation, {"x", "y", "z", "w"}, pose.orientation)) {
    return Malformed("pose.orientation is not {x, y, z, w} of finite numbers");
  }
  return pose;
}

Result<std::string> TextFromCdr(std::string_view message) {
  Bytes bytes(message);
  const auto encapsulation = bytes.Text(4);
  if (!encapsulation || (*encapsulation)[1] != 1) return Malformed("no little-endian CDR");
  const auto length = bytes.Number();
  if (!length || *length == 0) return Malformed("no text");
  const auto text = bytes.Text(*length);
  if (!text || text->back() != '\0') return Malformed("a text that is cut off");
  return std::string(text->substr(0, text->size() - 1));
}

}  // namespace conav::foxglove
