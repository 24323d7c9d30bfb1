#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>

namespace conav::bench {

/// What a row of the account counts: frames from one host to another for one topic. Topics of robots
/// and worlds are under their pattern ("/{}/state"); what belongs to no topic has a name in
/// parentheses.
struct WireRow {
  int from;
  int to;
  std::string topic;
  auto operator<=>(const WireRow&) const = default;
};

/// Counts the bytes of Ethernet frames by topic: learns the topics' names from RTPS discovery, and
/// gives acknowledgments and repeats to the topic of the writer. The headers of a frame belong to
/// one of the topics in it.
/// Threads: safe to call concurrently.
class WireAccount {
 public:
  void Add(int from, int to, std::span<const std::uint8_t> frame);
  /// What was added since the last call.
  std::map<WireRow, std::uint64_t> Take();

 private:
  using Guid = std::array<std::uint8_t, 16>;

  std::map<std::string, std::uint64_t> Split(std::span<const std::uint8_t> frame);
  std::map<std::string, std::uint64_t> SplitRtps(std::span<const std::uint8_t> message);
  void Learn(std::span<const std::uint8_t> data, std::uint8_t flags);
  std::string NameOf(const Guid& writer) const;

  std::mutex mutex_;  // guards what follows
  std::map<Guid, std::string> topics_;
  std::map<WireRow, std::uint64_t> bytes_;
};

}  // namespace conav::bench
