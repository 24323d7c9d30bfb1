#include "support/network_hosts.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <linux/ethtool.h>
#include <linux/if_packet.h>
#include <linux/sockios.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <queue>
#include <random>
#include <stdexcept>
#include <thread>

#include "support/wait.h"

namespace conav::test {
namespace {

using std::chrono::steady_clock;

constexpr int kMostHosts = 9;
constexpr int kHubNamespace = -1;
constexpr std::size_t kLongestFrame = 2048;  // the interfaces have the usual 1500 bytes
constexpr int kSocketBuffer = 16 << 20;

/// Moves the calling thread there.
void EnterNamespace(const std::string& name) {
  const int file = open(("/run/netns/" + name).c_str(), O_RDONLY | O_CLOEXEC);
  const bool entered = file >= 0 && setns(file, CLONE_NEWNET) == 0;
  if (file >= 0) close(file);
  if (!entered) throw std::runtime_error("namespace " + name + " cannot be entered");
}

/// Makes the host's kernel fill in the checksums, which it else leaves to the network card, and
/// waits until the interface runs.
void PrepareInterface() {
  const int any_socket = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ethtool_value off{ETHTOOL_STXCSUM, 0};
  ifreq request{};
  std::strcpy(request.ifr_name, "cn0");
  request.ifr_data = reinterpret_cast<char*>(&off);
  const bool fills = ioctl(any_socket, SIOCETHTOOL, &request) == 0;
  const bool runs = WaitUntil([&] {
    return ioctl(any_socket, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_RUNNING) != 0;
  });
  close(any_socket);
  if (!fills || !runs) throw std::runtime_error("interface cn0 cannot be prepared");
}

/// The hub's end of a host's cable.
int OpenPort(int host) {
  const int port = socket(AF_PACKET, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, htons(ETH_P_ALL));
  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(ETH_P_ALL);
  address.sll_ifindex = static_cast<int>(if_nametoindex(fmt::format("port{}", host).c_str()));
  if (port < 0 || bind(port, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error(fmt::format("port{} cannot be opened", host));
  }
  setsockopt(port, SOL_SOCKET, SO_RCVBUFFORCE, &kSocketBuffer, sizeof kSocketBuffer);
  setsockopt(port, SOL_SOCKET, SO_SNDBUFFORCE, &kSocketBuffer, sizeof kSocketBuffer);
  const int on = 1;
  setsockopt(port, SOL_PACKET, PACKET_IGNORE_OUTGOING, &on, sizeof on);
  packet_mreq all{address.sll_ifindex, PACKET_MR_PROMISC, 0, {}};
  setsockopt(port, SOL_PACKET, PACKET_ADD_MEMBERSHIP, &all, sizeof all);
  return port;
}

}  // namespace

/// Carries frames between the ports until destroyed. A host's interface has the address
/// 02:00:00:00:00:<host>.
class NetworkHosts::Hub {
 public:
  /// Throws std::runtime_error.
  Hub(const std::vector<std::string>& hosts, const std::string& home, Multicast multicast,
      Observer observer)
      : multicast_(multicast),
        observer_(std::move(observer)),
        cut_(hosts.size(), false),
        longest_(hosts.size(), kLongestFrame),
        last_due_(hosts.size()) {
    std::exception_ptr failure;
    // A thread of its own, which ends here: only it changes its namespace.
    std::jthread([&] {
      try {
        for (const std::string& host : hosts) {
          EnterNamespace(host);
          PrepareInterface();
        }
        EnterNamespace(home);
        for (int host = 0; host < static_cast<int>(hosts.size()); ++host) {
          ports_.push_back({OpenPort(host), POLLIN, 0});
        }
      } catch (...) {
        failure = std::current_exception();
      }
    }).join();
    if (failure) std::rethrow_exception(failure);
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        Wait();
        for (int host = 0; host < static_cast<int>(ports_.size()); ++host) ReceiveFrom(host);
        SendDue();
      }
    });
  }
  ~Hub() {
    thread_ = {};
    for (const pollfd& port : ports_) close(port.fd);
  }

  void SetFaults(const LinkFaults& faults) {
    const std::lock_guard lock(mutex_);
    faults_ = faults;
  }
  void Cut(int host, bool cut) {
    const std::lock_guard lock(mutex_);
    cut_[static_cast<std::size_t>(host)] = cut;
  }
  void SetLongest(int host, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    longest_[static_cast<std::size_t>(host)] = bytes + ETH_HLEN;
  }

 private:
  struct Frame {
    steady_clock::time_point due;
    std::uint64_t number;  // those that are due together keep their order
    int from;
    int to;
    std::vector<std::uint8_t> bytes;
    bool operator<(const Frame& other) const {
      return due != other.due ? due > other.due : number > other.number;
    }
  };

  void Wait() {
    std::chrono::nanoseconds left = std::chrono::milliseconds(20);
    if (!frames_.empty()) {
      left = std::clamp<std::chrono::nanoseconds>(frames_.top().due - steady_clock::now(),
                                                  std::chrono::nanoseconds(0), left);
    }
    const timespec timeout{0, static_cast<long>(left.count())};
    ppoll(ports_.data(), ports_.size(), &timeout, nullptr);
  }

  void ReceiveFrom(int host) {
    std::array<std::uint8_t, kLongestFrame> buffer;
    for (;;) {
      const ssize_t size =
          recv(ports_[static_cast<std::size_t>(host)].fd, buffer.data(), buffer.size(), 0);
      if (size < ETH_HLEN) return;
      const auto bytes = std::span(buffer).first(static_cast<std::size_t>(size));
      const bool to_all = (bytes[0] & 1) != 0;
      if (bytes[0] == 1 && multicast_ == Multicast::kOff) continue;  // 01:00:5e:...: IPv4's
      for (int to = 0; to < static_cast<int>(ports_.size()); ++to) {
        if (to != host && (to_all || bytes[5] == to)) Accept(host, to, bytes);
      }
    }
  }

  void Accept(int from, int to, std::span<const std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    const auto target = static_cast<std::size_t>(to);
    if (cut_[static_cast<std::size_t>(from)] || cut_[target]) return;
    if (bytes.size() > std::min(longest_[static_cast<std::size_t>(from)], longest_[target])) return;
    std::uniform_real_distribution<double> share(0.0, 1.0);
    if (share(random_) < faults_.loss) return;
    const double off = 2.0 * share(random_) - 1.0;
    const auto delay =
        faults_.delay + std::chrono::duration_cast<std::chrono::microseconds>(off * faults_.jitter);
    const auto due = std::max(steady_clock::now() + delay, last_due_[target]);
    last_due_[target] = due;
    frames_.push({due, next_number_++, from, to, {bytes.begin(), bytes.end()}});
  }

  void SendDue() {
    while (!frames_.empty() && frames_.top().due <= steady_clock::now()) {
      const Frame& frame = frames_.top();
      const int port = ports_[static_cast<std::size_t>(frame.to)].fd;
      const auto size = static_cast<ssize_t>(frame.bytes.size());
      if (send(port, frame.bytes.data(), frame.bytes.size(), 0) == size && observer_) {
        observer_(frame.from, frame.to, frame.bytes);
      }
      frames_.pop();
    }
  }

  const Multicast multicast_;
  const Observer observer_;
  std::vector<pollfd> ports_;
  std::mutex mutex_;  // guards faults_, cut_ and longest_
  LinkFaults faults_;
  std::vector<bool> cut_;
  std::vector<std::size_t> longest_;
  // Of the hub's thread alone.
  std::vector<steady_clock::time_point> last_due_;
  std::priority_queue<Frame> frames_;
  std::uint64_t next_number_ = 0;
  std::mt19937_64 random_{1};
  std::jthread thread_;
};

NetworkHosts::NetworkHosts(int count, Multicast multicast, Observer observer) {
  if (count > kMostHosts) throw std::runtime_error("too many hosts");
  AddNamespace(kHubNamespace);
  std::vector<std::string> hosts;
  for (int host = 0; host < count && problem_.empty(); ++host) {
    AddNamespace(host);
    hosts.push_back(NameOf(host));
    Run(fmt::format(
        "ip -n {0} link add cn0 address 02:00:00:00:00:0{2} type veth peer name port{2} netns {1} "
        "&& ip -n {1} link set port{2} up && ip -n {0} addr add {3}/24 dev cn0 && "
        "ip -n {0} link set cn0 multicast {4} up && ip -n {0} link set lo up",
        NameOf(host), NameOf(kHubNamespace), host, Address(host),
        multicast == Multicast::kOn ? "on" : "off"));
  }
  if (!problem_.empty()) return;
  try {
    hub_ = std::make_unique<Hub>(hosts, NameOf(kHubNamespace), multicast, std::move(observer));
  } catch (const std::exception& error) {
    problem_ = error.what();
  }
}

NetworkHosts::~NetworkHosts() {
  hub_.reset();
  for (const int host : namespaces_) Run("ip netns del " + NameOf(host));
}

void NetworkHosts::Enter(int host) const { EnterNamespace(NameOf(host)); }

void NetworkHosts::SetFaults(const LinkFaults& faults) { hub_->SetFaults(faults); }

void NetworkHosts::SetLongest(int host, std::size_t bytes) { hub_->SetLongest(host, bytes); }

void NetworkHosts::Cut(int host, bool cut) { hub_->Cut(host, cut); }

std::string NetworkHosts::NameOf(int host) {
  const std::string kind = host == kHubNamespace ? "hub" : std::to_string(host);
  return fmt::format("conav-{}-{}", getpid(), kind);
}

void NetworkHosts::AddNamespace(int host) {
  Run("ip netns add " + NameOf(host));
  if (problem_.empty()) namespaces_.push_back(host);
}

void NetworkHosts::Run(const std::string& command) {
  const bool good = std::system(("(" + command + ") 2>/dev/null").c_str()) == 0;
  if (!good && problem_.empty()) problem_ = "'" + command + "' failed";
}

}  // namespace conav::test
