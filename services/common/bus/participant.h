#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/named.h"

namespace conav {
class ConfigReader;
}

namespace conav::bus {

/// Lets one thread sleep until one of many receive threads has something for it.
class Notifier {
 public:
  void Notify() {
    {
      const std::lock_guard lock(mutex_);
      pending_ = true;
    }
    condition_.notify_one();
  }

  /// False when `timeout` passed without a Notify() since the last return.
  bool Wait(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    const bool notified = condition_.wait_for(lock, timeout, [this] { return pending_; });
    pending_ = false;
    return notified;
  }

 private:
  std::mutex mutex_;  // guards pending_
  std::condition_variable condition_;
  bool pending_ = false;
};

class Backend;
class InMemoryBus;

/// The DDS implementations, which talk to each other.
enum class Vendor { kCycloneDds, kFastDds };

inline constexpr std::array kVendors{Vendor::kCycloneDds, Vendor::kFastDds};
/// The vendor with the better measurements (conav-bench-bus).
inline constexpr Vendor kDefaultVendor = Vendor::kCycloneDds;

constexpr std::string_view Name(Vendor vendor) {
  switch (vendor) {
    case Vendor::kCycloneDds:
      return "cyclonedds";
    case Vendor::kFastDds:
      return "fastdds";
  }
  return "";
}

constexpr std::optional<Vendor> ParseVendor(std::string_view name) {
  return FindNamed(kVendors, name);
}

/// How a process shows its node to ROS 2 tools: by ros_discovery_info, which has one name and two
/// layouts. A ROS 2 node that reads the other layout takes gigabytes or finds no node at all (seen
/// with Humble), so kNone, which publishes none, is for where the distribution is not known.
enum class RosDistribution { kNone, kHumble, kJazzy };

inline constexpr std::array kRosDistributions{RosDistribution::kNone, RosDistribution::kHumble,
                                              RosDistribution::kJazzy};

constexpr std::string_view Name(RosDistribution distribution) {
  switch (distribution) {
    case RosDistribution::kNone:
      return "none";
    case RosDistribution::kHumble:
      return "humble";
    case RosDistribution::kJazzy:
      return "jazzy";
  }
  return "";
}

inline constexpr const char* kDefaultSystem = "conav";

/// How a process takes part in DDS: the section `bus:` of a service's YAML file.
struct ParticipantOptions {
  /// None = environment CONAV_DDS, else the default vendor.
  std::optional<Vendor> vendor;
  /// -1 = environment CONAV_DOMAIN, else ROS_DOMAIN_ID, else 0.
  int domain_id = -1;
  /// Name or address of the network interface; empty = environment CONAV_INTERFACE, else the
  /// vendor's choice. "lo" stays on this machine.
  std::string interface;
  /// Host addresses of other participants. When set, multicast is off.
  std::vector<std::string> peers;
  /// None = environment ROS_DISTRO (Foxy to Humble have one layout, Iron and later the other), else
  /// kNone.
  std::optional<RosDistribution> ros_distribution;
  /// Lease of the participant and of its writers' liveliness, seconds: how soon others notice that
  /// this process was killed or cut off. They also give up a process that hangs for longer (a
  /// suspended computer, say). When it resumes, Cyclone DDS finds it again; if one side is Fast
  /// DDS, sometimes only a restart helps (measured). So prefer too long to too short.
  double lease_s = 10.0;
  /// The system that this process belongs to. It takes no message of a process of another system in
  /// its domain; programs that name no system, such as those of ROS 2, belong to each. Empty =
  /// environment CONAV_SYSTEM, else kDefaultSystem.
  std::string system;
  /// Folder of the keystore for DDS security (`./conav keystore`, or SROS2's). Empty = environment
  /// ROS_SECURITY_KEYSTORE where ROS_SECURITY_ENABLE is true, else no security.
  std::string keystore;
  /// The enclave of this process there. Empty = environment ROS_SECURITY_ENCLAVE_OVERRIDE, else
  /// /conav/<host>/<role>/<vendor>.
  std::string enclave;
  /// What the process is in the keystore; its program says so, no configuration.
  std::string role = "tools";

  void Visit(ConfigReader& reader);
};

/// A change in the connections of a participant. When a process dies, both vendors report
/// kUnmatched after the lease. Cyclone DDS reports kLivelinessLost earlier for a writer whose
/// liveliness lease is shorter than its participant's; ours are equal, foreign ones may not be.
/// (Fast DDS only monitors liveliness for readers that ask for a lease, and such readers would not
/// match ROS 2 writers.)
struct Event {
  enum class Kind {
    kMatched,
    kUnmatched,
    kLivelinessLost,
    kLivelinessGained,
    kIncompatibleQos,
    kOtherSystem
  };
  Kind kind;
  std::string topic;
  std::string detail;  // for incompatible QoS the policy's name, for another system that system's
};

/// One process's connection to the bus: one DDS participant, which ROS 2 tools see as one node.
///
/// Its publishers and subscribers must be destroyed before it.
/// Threads: safe to call concurrently.
class Participant {
 public:
  /// Throws StartupError: unknown vendor, domain out of [0, 232], unusable interface, security
  /// without its files.
  Participant(const std::string& node_name, const ParticipantOptions& options);
  /// A participant of an in-memory bus, for tests: same contract, delivery before Publish()
  /// returns.
  Participant(const std::string& node_name, std::shared_ptr<InMemoryBus> bus);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  /// Blocks until a subscriber of this participant has data, Wake() is called, or `timeout` passes;
  /// returns false on timeout. Data since the last Wait() counts, so no wake-up is lost. One
  /// waiting thread.
  bool Wait(std::chrono::nanoseconds timeout);
  void Wake();

  /// Connection events since the last call.
  std::vector<Event> TakeEvents();

  const std::string& node_name() const { return node_name_; }
  /// "cyclonedds", "fastdds" or "in-memory".
  const std::string& vendor() const { return vendor_; }

  /// Whether what it sends can leave this machine: its interface is not the loopback one.
  bool over_link() const;

  Backend& backend() { return *backend_; }
  Notifier& notifier() { return *notifier_; }

 private:
  std::string node_name_;
  std::string vendor_;
  std::unique_ptr<Notifier> notifier_;
  std::unique_ptr<Backend> backend_;
};

}  // namespace conav::bus
