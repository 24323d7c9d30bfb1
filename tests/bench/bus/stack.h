#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/qos.h"

/// One way of sending bytes, behind the same few calls: our bus or a vendor's own API.
namespace conav::bench {

/// Ping and pong: reliable, newest ten. Flood: reliable, keep all.
inline constexpr bus::Qos kPingQos = bus::kDefaultQos;
inline constexpr bus::Qos kFloodQos = bus::kRequestQos;
inline constexpr const char* kPingTopic = "/bench/ping";
inline constexpr const char* kPongTopic = "/bench/pong";
inline constexpr const char* kFloodTopic = "/bench/flood";

/// The last message of a flood carries this id; the echo answers it with a pong.
inline constexpr std::uint64_t kEndOfFlood = ~std::uint64_t{0};

/// The side that asks. `on_pong` is called with the id of each answer, on the receive thread.
class Pinger {
 public:
  using OnPong = std::function<void(std::uint64_t id)>;

  virtual ~Pinger() = default;
  /// The payload of what is sent from now on.
  virtual void Prepare(std::size_t size) = 0;
  virtual void SendPing(std::uint64_t id) = 0;
  /// False when the message was not taken.
  virtual bool SendFlood(std::uint64_t id) = 0;
};

/// The side that answers: each ping with a pong of the same content, from the receive thread.
class Echo {
 public:
  virtual ~Echo() = default;
};

/// Network, domain and vendor of both sides.
struct StackOptions {
  std::string vendor;  // "cyclonedds" or "fastdds"
  bool raw = false;    // the vendor's own API and type instead of the bus
  int domain_id = 0;

  std::string name() const { return (raw ? "raw " : "bus ") + vendor; }
};

std::unique_ptr<Pinger> MakePinger(const StackOptions& options, Pinger::OnPong on_pong);
std::unique_ptr<Echo> MakeEcho(const StackOptions& options);

/// The bus options of a stack; the raw stacks take network settings and QoS from them too.
bus::ParticipantOptions BusOptions(const StackOptions& options);

std::unique_ptr<Pinger> MakeRawCyclonePinger(const StackOptions& options, Pinger::OnPong on_pong);
std::unique_ptr<Echo> MakeRawCycloneEcho(const StackOptions& options);
std::unique_ptr<Pinger> MakeRawFastPinger(const StackOptions& options, Pinger::OnPong on_pong);
std::unique_ptr<Echo> MakeRawFastEcho(const StackOptions& options);

}  // namespace conav::bench
