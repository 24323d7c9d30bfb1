#include "launcher/host_probe.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <linux/errqueue.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/runtime/clock.h"

namespace conav::launcher {
namespace {

using nlohmann::json;

constexpr const char* kGroup = "239.255.0.1";  // of DDS (RTPS 2.5, 9.6.2.3)
constexpr std::size_t kLongest = 2048;

/// Empty for what is no text of ours.
json Parsed(const std::string& text) {
  json message = json::parse(text, nullptr, false);
  return message.is_object() && message.contains("conav_doctor") ? message : json();
}

void Set(int socket, int level, int option, const auto& value) {
  setsockopt(socket, level, option, &value, sizeof value);
}

}  // namespace

HostProbe::HostProbe(const HostsPlan& plan, HostFacts own, int domain_id)
    : own_(std::move(own)), port_(PortOf(domain_id)) {
  bus::ParticipantOptions options = plan.bus;
  for (const Host& host : plan.hosts) {
    if (host.name == own_.host) options.interface = host.interface;
  }
  const bus::Network network = bus::ResolveNetwork(options);
  for (const Host& host : plan.hosts) {
    if (host.name == own_.host) continue;
    PeerReport& report = peers_[host.name];
    try {
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(port_));
      inet_pton(AF_INET, bus::ResolvePeer(host.address).c_str(), &address.sin_addr);
      addresses_[host.name] = address;
    } catch (const StartupError& error) {
      report.problem = error.what();
    }
  }
  socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_port = htons(static_cast<std::uint16_t>(port_));
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0) {
    const std::string reason = std::strerror(errno);
    close(socket_);
    throw StartupError(fmt::format("UDP port {}: {}", port_, reason));
  }
  Set(socket_, IPPROTO_IP, IP_RECVERR, 1);
  ip_mreqn group{};
  inet_pton(AF_INET, kGroup, &group.imr_multiaddr);
  inet_pton(AF_INET, network.interface_address.c_str(), &group.imr_address);
  Set(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, group);
  Set(socket_, IPPROTO_IP, IP_MULTICAST_IF, group);
  Set(socket_, IPPROTO_IP, IP_MULTICAST_LOOP, 0);
}

HostProbe::~HostProbe() { close(socket_); }

bool HostProbe::Send(const std::string& text, std::size_t size, Kind kind, const sockaddr_in& to) {
  // Whole: never in pieces, whatever the kernel believes of the way.
  Set(socket_, IPPROTO_IP, IP_MTU_DISCOVER,
      kind == Kind::kWhole ? IP_PMTUDISC_PROBE : IP_PMTUDISC_DONT);
  std::string padded = text;
  padded.resize(std::max(size, text.size()), ' ');
  return sendto(socket_, padded.data(), padded.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                sizeof to) >= 0 ||
         errno == ECONNREFUSED;  // of a datagram before
}

void HostProbe::Ask(const std::string& host, Kind kind, std::size_t size) {
  const json question{
      {"conav_doctor", "asks"}, {"kind", kind}, {"size", size}, {"asked", WallSeconds()}};
  sockaddr_in to = addresses_.at(host);
  if (kind == Kind::kMulticast) inet_pton(AF_INET, kGroup, &to.sin_addr);
  if (Send(question.dump(), size, kind, to) || errno == EMSGSIZE) return;
  if (kind != Kind::kMulticast) peers_[host].problem = std::strerror(errno);
}

void HostProbe::Ask() {
  for (const auto& [host, address] : addresses_) {
    const PeerReport& report = peers_[host];
    for (const std::size_t size : kSizes) {
      if (!report.whole.contains(size)) Ask(host, Kind::kWhole, size);
    }
    Ask(host, Kind::kInPieces, kSizes.front());  // for the clocks
    if (!report.in_pieces.contains(kBusDatagram)) Ask(host, Kind::kInPieces, kBusDatagram);
    if (!report.multicast) Ask(host, Kind::kMulticast, kSizes.front());
  }
}

void HostProbe::Receive(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pollfd ready{socket_, POLLIN, 0};
    if (left.count() <= 0 || poll(&ready, 1, static_cast<int>(left.count())) <= 0) return;
    if ((ready.revents & POLLERR) != 0) TakeErrors();
    std::array<char, kLongest> buffer;
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t size = recvfrom(socket_, buffer.data(), buffer.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &length);
    if (size <= 0) continue;
    for (const auto& [host, address] : addresses_) {
      if (address.sin_addr.s_addr != from.sin_addr.s_addr) continue;
      Take({buffer.data(), static_cast<std::size_t>(size)}, host, from);
    }
  }
}

void HostProbe::Take(const std::string& text, const std::string& host, const sockaddr_in& from) {
  const double now_s = WallSeconds();
  json message = Parsed(text);
  PeerReport& report = peers_[host];
  try {
    if (message.at("conav_doctor") == "asks") {
      const auto kind = message.at("kind").get<Kind>();
      message.update({{"conav_doctor", "answers"},
                      {"received", now_s},
                      {"host", own_.host},
                      {"version", own_.version},
                      {"plan", own_.plan},
                      {"authority", own_.authority},
                      {"sent", WallSeconds()}});
      const std::string answer = message.dump();
      if (answer.size() <= text.size()) Send(answer, text.size(), kind, from);
      return;
    }
    report.facts = {message.at("host"), message.at("version"), message.at("plan"),
                    message.at("authority")};
    report.clock.Add(message.at("asked"), message.at("received"), message.at("sent"), now_s);
    const auto kind = message.at("kind").get<Kind>();
    if (kind == Kind::kMulticast) report.multicast = true;
    if (kind == Kind::kWhole) report.whole.insert(text.size());
    if (kind == Kind::kInPieces) report.in_pieces.insert(text.size());
  } catch (const json::exception&) {
    // Not of a doctor.
  }
}

void HostProbe::TakeErrors() {
  while (true) {
    sockaddr_in to{};
    alignas(cmsghdr) std::array<char, 512> control;
    msghdr header{};
    header.msg_name = &to;
    header.msg_namelen = sizeof to;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    if (recvmsg(socket_, &header, MSG_ERRQUEUE) < 0) return;
    for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
         part = CMSG_NXTHDR(&header, part)) {
      if (part->cmsg_level != IPPROTO_IP || part->cmsg_type != IP_RECVERR) continue;
      const auto* error = reinterpret_cast<const sock_extended_err*>(CMSG_DATA(part));
      if (error->ee_errno == EMSGSIZE) continue;
      for (const auto& [host, address] : addresses_) {
        if (address.sin_addr.s_addr != to.sin_addr.s_addr) continue;
        peers_[host].problem =
            std::strerror(static_cast<int>(error->ee_errno));  // "Connection refused": no doctor
      }
    }
  }
}

}  // namespace conav::launcher
