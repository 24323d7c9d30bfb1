#include "nhpm/model/frame.h"

#include <fmt/format.h>

#include "common/runtime/demand.h"
#include "common/runtime/sha256.h"

namespace conav::nhpm {
namespace {

constexpr std::size_t kMagicSize = 4;
constexpr std::size_t kDigestSize = 64;
constexpr std::size_t kHeaderSize = kMagicSize + 4 + 8 + kDigestSize;

void AppendNumber(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
}

std::uint64_t NumberOf(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;)
    value = value << 8 | static_cast<std::uint8_t>(bytes[i]);
  return value;
}

template <class... Values>
tl::unexpected<Error> Malformed(fmt::format_string<Values...> text, Values&&... values) {
  return Fail(ErrorCode::kMalformed, fmt::format(text, std::forward<Values>(values)...));
}

}  // namespace

std::string Frame(const FrameKind& kind, std::string_view payload) {
  DEMAND(kind.magic.size() == kMagicSize, kind.magic);
  std::string bytes(kind.magic);
  AppendNumber(bytes, kind.version, 4);
  AppendNumber(bytes, payload.size(), 8);
  bytes += Sha256Hex(payload);
  return bytes.append(payload);
}

Result<std::string_view> Unframe(const FrameKind& kind, std::string_view bytes) {
  if (bytes.empty()) return Malformed("empty, so no {}", kind.name);
  if (!bytes.starts_with(kind.magic)) return Malformed("no {}", kind.name);
  if (bytes.size() < kHeaderSize) {
    return Malformed("cut off after {} bytes of its header", bytes.size());
  }
  const std::uint64_t version = NumberOf(bytes.substr(4, 4));
  if (version != kind.version) {
    return Malformed("{} of format version {}; this program reads version {}", kind.name, version,
                     kind.version);
  }
  const std::uint64_t size = NumberOf(bytes.substr(8, 8));
  const std::string_view payload = bytes.substr(kHeaderSize);
  if (payload.size() != size) {
    return Malformed("{} bytes where its header says {}: {}", payload.size(), size,
                     payload.size() < size ? "cut off" : "something was appended");
  }
  if (Sha256Hex(payload) != bytes.substr(16, kDigestSize)) {
    return Malformed("damaged: its SHA-256 is not the one in its header");
  }
  return payload;
}

}  // namespace conav::nhpm
