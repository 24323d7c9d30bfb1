#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "common/bus/qos.h"
#include "support/loopback.h"

/// One way of sending bytes, behind the same few calls: our bus or a vendor's own API.
namespace conav::bench {

/// What goes from one process to the other.
struct Channel {
  const char* topic;
  bus::Qos qos;
  std::size_t index;
};
/// Ping and pong: reliable, newest ten. Flood: reliable, keep all.
inline constexpr Channel kPing{"/bench/ping", bus::kDefaultQos, 0};
inline constexpr Channel kPong{"/bench/pong", bus::kDefaultQos, 1};
inline constexpr Channel kFlood{"/bench/flood", bus::kRequestQos, 2};
inline constexpr std::size_t kChannels = 3;

class Stack {
 public:
  /// Called on the receive thread; `message` is the stack's own.
  using OnMessage = std::function<void(std::uint64_t id, const void* message)>;

  virtual ~Stack() = default;
  /// Makes a writer, once per channel and before any Listen().
  virtual void Offer(const Channel& channel) = 0;
  virtual void Listen(const Channel& channel, OnMessage on_message) = 0;
  /// The payload of what Send() sends from now on.
  virtual void Prepare(std::size_t size) = 0;
  /// False when the message was not taken.
  virtual bool Send(const Channel& channel, std::uint64_t id) = 0;
  /// Sends what came.
  virtual void SendBack(const Channel& channel, const void* message) = 0;
};

/// Network, domain and vendor of both sides.
struct StackOptions {
  std::string vendor;  // "cyclonedds" or "fastdds"
  bool raw = false;    // the vendor's own API and type instead of the bus
  int domain_id = 0;
  std::string keystore;  // with the enclaves of host "bench"; empty = no security

  std::string name() const {
    return (raw ? "raw " : keystore.empty() ? "bus " : "secured bus ") + vendor;
  }
  /// The raw stacks take network settings and QoS from it, too.
  bus::ParticipantOptions OnLoopback() const {
    bus::ParticipantOptions options = test::OnLoopback(vendor, domain_id);
    options.keystore = keystore;
    options.enclave = "/conav/bench/tools/" + vendor;
    return options;
  }
};

std::unique_ptr<Stack> MakeRawCyclone(const StackOptions& options);
std::unique_ptr<Stack> MakeRawFast(const StackOptions& options);

}  // namespace conav::bench
