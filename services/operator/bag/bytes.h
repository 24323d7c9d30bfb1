#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Little-endian numbers and length-prefixed texts, as MCAP has them.
namespace conav::bag {

using Bytes = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;
using TextMap = std::map<std::string, std::string>;

class ByteWriter {
 public:
  /// Appends to `bytes`, which outlives it.
  explicit ByteWriter(Bytes& bytes) : bytes_(bytes) {}

  void U8(std::uint8_t value) { Number(value, 1); }
  void U16(std::uint16_t value) { Number(value, 2); }
  void U32(std::uint32_t value) { Number(value, 4); }
  void U64(std::uint64_t value) { Number(value, 8); }
  void Raw(ByteSpan bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  void Text(std::string_view text) {
    U32(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  void Map(const TextMap& map) {
    const std::size_t length_at = BeginLength(4);
    for (const auto& [key, value] : map) {
      Text(key);
      Text(value);
    }
    EndLength(length_at, 4);
  }

  /// A length of `width` bytes that EndLength fills in with what was appended since.
  std::size_t BeginLength(int width) {
    const std::size_t at = bytes_.size();
    Number(0, width);
    return at;
  }
  void EndLength(std::size_t at, int width) {
    std::uint64_t length = bytes_.size() - at - static_cast<std::size_t>(width);
    for (int i = 0; i < width; ++i, length >>= 8) {
      bytes_[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(length);
    }
  }

 private:
  void Number(std::uint64_t value, int width) {
    for (int i = 0; i < width; ++i, value >>= 8) bytes_.push_back(static_cast<std::uint8_t>(value));
  }

  Bytes& bytes_;
};

/// Reads zeros and nothing beyond the end, and tells afterwards with ok() whether it came to that.
class ByteReader {
 public:
  explicit ByteReader(ByteSpan bytes) : bytes_(bytes) {}

  std::uint8_t U8() { return static_cast<std::uint8_t>(Number(1)); }
  std::uint16_t U16() { return static_cast<std::uint16_t>(Number(2)); }
  std::uint32_t U32() { return static_cast<std::uint32_t>(Number(4)); }
  std::uint64_t U64() { return Number(8); }
  ByteSpan Raw(std::uint64_t size) {
    if (size > bytes_.size()) {
      ok_ = false;
      bytes_ = {};
      return {};
    }
    const ByteSpan taken = bytes_.first(static_cast<std::size_t>(size));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  std::string Text() {
    const ByteSpan text = Raw(U32());
    return {text.begin(), text.end()};
  }
  TextMap Map() {
    ByteReader inner(Raw(U32()));
    TextMap map;
    while (!inner.at_end()) {
      std::string key = inner.Text();
      map[std::move(key)] = inner.Text();
    }
    ok_ = ok_ && inner.ok();
    return map;
  }

  bool at_end() const { return bytes_.empty(); }
  bool ok() const { return ok_; }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::uint64_t Number(std::size_t width) {
    std::uint64_t value = 0;
    const ByteSpan bytes = Raw(width);
    for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | bytes[i];
    return value;
  }

  ByteSpan bytes_;
  bool ok_ = true;
};

}  // namespace conav::bag
