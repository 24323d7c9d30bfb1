#include "bench/link/wire_account.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

namespace conav::bench {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kWriterHost = 1;
constexpr std::uint8_t kReaderHost = 2;
const Bytes kWriter{0, 0, 7, 3};
const Bytes kReader{0, 0, 7, 4};

Bytes operator+(Bytes first, const Bytes& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

Bytes Prefix(std::uint8_t host) { return Bytes(12, host); }

/// A submessage in little endian.
Bytes Submessage(std::uint8_t id, const Bytes& body) {
  return Bytes{id, 1, static_cast<std::uint8_t>(body.size()), 0} + body;
}

/// Ethernet, IPv4, UDP and RTPS headers before them: 62 bytes.
Bytes Frame(std::uint8_t host, const Bytes& submessages) {
  Bytes frame(14 + 20 + 8, 0);
  frame[12] = 0x08;
  frame[14] = 0x45;
  frame[23] = 17;
  return frame + Bytes{'R', 'T', 'P', 'S', 2, 1, 1, 16} + Prefix(host) + submessages;
}

Bytes Parameter(std::uint8_t id, const Bytes& value) {
  return Bytes{id, 0, static_cast<std::uint8_t>(value.size()), 0} + value;
}

/// What discovery says of the writer on kWriterHost.
Bytes Publication(const std::string& topic) {
  Bytes name{static_cast<std::uint8_t>(topic.size() + 1), 0, 0, 0};
  name.insert(name.end(), topic.begin(), topic.end());
  name.resize((name.size() + 4) / 4 * 4, 0);
  const Bytes parameters =
      Parameter(0x05, name) + Parameter(0x5a, Prefix(kWriterHost) + kWriter) + Parameter(0x01, {});
  const Bytes header{0, 0, 16, 0, 0, 0, 3, 0xc7, 0, 0, 3, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0};
  return Submessage(0x15, header + Bytes{0, 3, 0, 0} + parameters);
}

Bytes Data(std::size_t size) {
  return Submessage(0x15, Bytes{0, 0, 16, 0} + kReader + kWriter + Bytes(size, 0));
}

Bytes AckNack() {
  return Submessage(0x0e, Prefix(kWriterHost)) + Submessage(0x06, kReader + kWriter + Bytes(16, 0));
}

std::uint64_t Total(const std::map<WireRow, std::uint64_t>& account) {
  return std::accumulate(account.begin(), account.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& entry) { return sum + entry.second; });
}

}  // namespace

TEST_CASE("bytes go to the topic that discovery names, acknowledgments as well", "[bench]") {
  WireAccount account;
  const Bytes data = Frame(kWriterHost, Data(100));
  account.Add(0, 1, data);
  CHECK(account.Take() == std::map<WireRow, std::uint64_t>{{{0, 1, "(not known)"}, data.size()}});
  account.Add(0, 2, Frame(kWriterHost, Publication("rt/r12/state")));
  const Bytes answer = Frame(kReaderHost, AckNack());
  account.Add(0, 1, data);
  account.Add(0, 1, data);
  account.Add(1, 0, answer);
  const auto counted = account.Take();
  CHECK(counted.at({0, 1, "/{}/state"}) == 2 * data.size());
  CHECK(counted.at({1, 0, "/{}/state"}) == answer.size());
  CHECK(counted.at({0, 2, "(discovery: endpoints)"}) > 0);
  CHECK(account.Take().empty());
}

TEST_CASE("a frame with two topics counts once", "[bench]") {
  WireAccount account;
  account.Add(0, 1, Frame(kWriterHost, Publication("rt/clock") + Data(10)));
  const auto counted = account.Take();
  CHECK(counted.at({0, 1, "/clock"}) == 4 + 12 + 10);
  CHECK(Total(counted) == Frame(kWriterHost, Publication("rt/clock") + Data(10)).size());
}

TEST_CASE("whatever is on the wire is counted, cut short or not", "[bench]") {
  const Bytes frame = Frame(kWriterHost, Publication("rt/r1/state") + AckNack() + Data(10));
  for (std::size_t size = 14; size <= frame.size(); ++size) {
    WireAccount account;
    account.Add(0, 1, std::span(frame).first(size));
    CHECK(Total(account.Take()) == size);
  }
  Bytes fragment = frame;
  fragment[21] = 1;
  WireAccount account;
  account.Add(0, 1, fragment);
  CHECK(account.Take().at({0, 1, "(IP fragments)"}) == frame.size());
}

}  // namespace conav::bench
