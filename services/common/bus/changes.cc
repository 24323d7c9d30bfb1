#include "common/bus/changes.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>

namespace conav::bus {
namespace {

/// A run costs 8 bytes besides its own.
constexpr std::size_t kRunCost = 8;

std::uint32_t Crc32(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

struct Run {
  std::size_t begin;
  std::size_t end;
};

/// Where `now` has other bytes than `before`, or more. Runs with little between them are one.
std::vector<Run> RunsOf(std::span<const std::uint8_t> before, std::span<const std::uint8_t> now) {
  std::vector<Run> runs;
  const auto add = [&](std::size_t begin, std::size_t end) {
    if (!runs.empty() && begin <= runs.back().end + kRunCost) {
      runs.back().end = end;
    } else {
      runs.push_back({begin, end});
    }
  };
  const std::size_t common = std::min(before.size(), now.size());
  for (std::size_t at = 0; at < common; ++at) {
    if (before[at] != now[at]) add(at, at + 1);
  }
  if (now.size() > common) add(common, now.size());
  return runs;
}

}  // namespace

conav_msgs::msg::MessageChange ChangeEncoder::Encode(std::span<const std::uint8_t> payload) {
  conav_msgs::msg::MessageChange change;
  change.size(static_cast<std::uint32_t>(payload.size()));
  change.whole(last_.empty() || since_whole_ == kMostInARow);
  since_whole_ = change.whole() ? 0 : since_whole_ + 1;
  if (change.whole()) {
    change.bytes().assign(payload.begin(), payload.end());
  } else {
    change.base(Crc32(last_));
    for (const auto& [begin, end] : RunsOf(last_, payload)) {
      change.offsets().push_back(static_cast<std::uint32_t>(begin));
      change.lengths().push_back(static_cast<std::uint32_t>(end - begin));
      const auto run = payload.subspan(begin, end - begin);
      change.bytes().insert(change.bytes().end(), run.begin(), run.end());
    }
  }
  last_.assign(payload.begin(), payload.end());
  return change;
}

Result<std::optional<std::span<const std::uint8_t>>> ChangeDecoder::Decode(
    const conav_msgs::msg::MessageChange& change) {
  const auto& bytes = change.bytes();
  if (change.whole()) {
    if (bytes.size() != change.size()) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("bytes: {} of {}", bytes.size(), change.size()));
    }
    last_ = bytes;
    return last_;
  }
  if (last_.empty() || change.base() != Crc32(last_)) return std::nullopt;
  if (change.offsets().size() != change.lengths().size() ||
      change.size() > last_.size() + bytes.size()) {
    return Fail(
        ErrorCode::kMalformed,
        fmt::format("size: {} from {} with {} offsets, {} lengths, {} bytes", change.size(),
                    last_.size(), change.offsets().size(), change.lengths().size(), bytes.size()));
  }
  std::vector<std::uint8_t> next = last_;
  next.resize(change.size());
  std::size_t taken = 0;
  for (std::size_t run = 0; run < change.offsets().size(); ++run) {
    const std::size_t begin = change.offsets()[run];
    const std::size_t length = change.lengths()[run];
    if (begin + length > next.size() || taken + length > bytes.size()) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("lengths[{}]: {} at {} of {} with {} bytes left", run, length, begin,
                              next.size(), bytes.size() - taken));
    }
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(taken), length,
                next.begin() + static_cast<std::ptrdiff_t>(begin));
    taken += length;
  }
  last_ = std::move(next);
  return last_;
}

}  // namespace conav::bus
