#include "bench/link/wire_account.h"

#include <algorithm>
#include <regex>
#include <utility>

namespace conav::bench {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kEthernetHeader = 14;
constexpr std::size_t kUdpHeader = 8;
constexpr std::size_t kRtpsHeader = 20;
constexpr std::size_t kPrefix = 12;

// RTPS 2.5, 9.4.5 and 9.3.1.3.
enum Submessage : std::uint8_t {
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoDestination = 0x0e,
  kNackFragment = 0x12,
  kHeartbeatFragment = 0x13,
  kData = 0x15,
  kDataFragment = 0x16,
};
constexpr std::uint32_t kParticipantWriter = 0x000100c2;
constexpr std::uint32_t kPublicationWriter = 0x000003c2;
constexpr std::uint32_t kSubscriptionWriter = 0x000004c2;
constexpr std::uint32_t kLivelinessWriter = 0x000200c2;
constexpr std::uint16_t kTopicName = 0x0005;
constexpr std::uint16_t kEndpointGuid = 0x005a;
constexpr std::uint16_t kSentinel = 0x0001;

/// Bytes from `offset` on; empty behind the end.
Bytes From(Bytes bytes, std::size_t offset) {
  return offset < bytes.size() ? bytes.subspan(offset) : Bytes();
}

std::uint16_t Number16(Bytes bytes, bool little) {
  return static_cast<std::uint16_t>(little ? bytes[0] | bytes[1] << 8 : bytes[0] << 8 | bytes[1]);
}

/// Calls visit(id, value) for each parameter; returns what follows the list.
template <class Visit>
Bytes ForEachParameter(Bytes list, bool little, Visit&& visit) {
  while (list.size() >= 4) {
    const std::uint16_t id = Number16(list, little);
    const std::size_t length = Number16(list.subspan(2), little);
    list = list.subspan(4);
    if (id == kSentinel || length > list.size()) break;
    visit(id, list.first(length));
    list = list.subspan(length);
  }
  return list;
}

/// "rt/r1/state" is "/{}/state".
std::string PatternOf(std::string name) {
  if (name.starts_with("rt/")) name.erase(0, 2);
  static const std::regex kEntity("^/(r|world|maze|w)[0-9]+/");
  return std::regex_replace(name, kEntity, "/{}/");
}

std::uint32_t EntityOf(const std::array<std::uint8_t, 16>& guid) {
  std::uint32_t entity = 0;
  for (std::size_t i = kPrefix; i < guid.size(); ++i) entity = entity << 8 | guid[i];
  return entity;
}

/// Where the writer's entity id stands in the body of a submessage; none in one without.
std::optional<std::size_t> WriterOffset(std::uint8_t id) {
  switch (id) {
    case kData:
    case kDataFragment:
      return 8;
    case kAckNack:
    case kHeartbeat:
    case kGap:
    case kNackFragment:
    case kHeartbeatFragment:
      return 4;
    default:
      return std::nullopt;
  }
}

}  // namespace

void WireAccount::Add(int from, int to, Bytes frame) {
  const std::lock_guard lock(mutex_);
  for (const auto& [topic, bytes] : Split(frame)) bytes_[{from, to, topic}] += bytes;
}

std::map<WireRow, std::uint64_t> WireAccount::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(bytes_, {});
}

std::map<std::string, std::uint64_t> WireAccount::Split(Bytes frame) {
  const Bytes ip = From(frame, kEthernetHeader);
  if (ip.size() < 20 || Number16(frame.subspan(12), false) != 0x0800 || ip[9] != 17)
    return {{"(no UDP)", frame.size()}};
  const std::size_t header = (ip[0] & 0x0f) * std::size_t{4};
  if ((Number16(ip.subspan(6), false) & 0x1fff) != 0) return {{"(IP fragments)", frame.size()}};
  const Bytes rtps = From(ip, header + kUdpHeader);
  constexpr std::string_view kMagic = "RTPS";
  if (rtps.size() < kRtpsHeader || !std::equal(kMagic.begin(), kMagic.end(), rtps.begin()))
    return {{"(no RTPS)", frame.size()}};
  auto result = SplitRtps(rtps);
  std::uint64_t counted = 0;
  for (const auto& [topic, bytes] : result) counted += bytes;
  if (result.empty()) return {{"(no RTPS)", frame.size()}};
  result.begin()->second += frame.size() - counted;
  return result;
}

std::map<std::string, std::uint64_t> WireAccount::SplitRtps(Bytes message) {
  std::map<std::string, std::uint64_t> result;
  const Bytes source = message.subspan(8, kPrefix);
  Bytes destination = source;
  Bytes rest = message.subspan(kRtpsHeader);
  while (rest.size() >= 4) {
    const std::uint8_t id = rest[0];
    const std::uint8_t flags = rest[1];
    std::size_t length = Number16(rest.subspan(2), (flags & 1) != 0);
    const Bytes body = rest.subspan(4);
    if (length == 0 || length > body.size()) length = body.size();  // 0: up to the end
    if (id == kInfoDestination && length >= kPrefix) destination = body.first(kPrefix);
    const auto offset = WriterOffset(id);
    if (offset && length >= *offset + 4) {
      const bool from_reader = id == kAckNack || id == kNackFragment;
      Guid writer;
      const auto entity = std::ranges::copy(from_reader ? destination : source, writer.begin()).out;
      std::ranges::copy(body.subspan(*offset, 4), entity);
      if (id == kData && EntityOf(writer) == kPublicationWriter) Learn(body.first(length), flags);
      result[NameOf(writer)] += 4 + length;
    }
    rest = body.subspan(length);
  }
  return result;
}

void WireAccount::Learn(Bytes data, std::uint8_t flags) {
  const bool little = (flags & 1) != 0;
  if (data.size() < 4) return;
  Bytes payload = From(data, 4 + std::size_t{Number16(data.subspan(2), little)});
  if ((flags & 2) != 0) payload = ForEachParameter(payload, little, [](auto, auto) {});
  if (payload.size() < 4) return;
  const bool little_payload = payload[1] == 3;
  std::string topic;
  std::optional<Guid> writer;
  ForEachParameter(payload.subspan(4), little_payload, [&](std::uint16_t id, Bytes value) {
    if (id == kTopicName && value.size() > 4) {
      const auto text = value.subspan(4);
      topic.assign(text.begin(), std::ranges::find(text, 0));
    } else if (id == kEndpointGuid && value.size() == 16) {
      std::ranges::copy(value, writer.emplace().begin());
    }
  });
  if (writer && !topic.empty()) topics_[*writer] = PatternOf(topic);
}

std::string WireAccount::NameOf(const Guid& writer) const {
  switch (EntityOf(writer)) {
    case kParticipantWriter:
      return "(discovery: participants)";
    case kPublicationWriter:
    case kSubscriptionWriter:
      return "(discovery: endpoints)";
    case kLivelinessWriter:
      return "(liveliness)";
    default:
      break;
  }
  const auto known = topics_.find(writer);
  return known != topics_.end() ? known->second : "(not known)";
}

}  // namespace conav::bench
