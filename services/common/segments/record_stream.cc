#include "common/segments/record_stream.h"

#include <fmt/format.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/stubs/logging.h>

namespace conav {
namespace {

constexpr std::size_t kMaxRecordBytes = std::size_t{32} * 1024 * 1024;
constexpr std::size_t kMaxVarintBytes = 5;

tl::unexpected<Error> Refuse(std::size_t record, const std::string& reason) {
  return Fail(ErrorCode::kMalformed, fmt::format("record {} {}", record, reason));
}

}  // namespace

std::string Delimited(const segments::Record& record) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream target(&bytes);
    google::protobuf::io::CodedOutputStream out(&target);
    out.SetSerializationDeterministic(true);  // equal records, equal bytes: the order of maps
    out.WriteVarint32(static_cast<std::uint32_t>(record.ByteSizeLong()));
    record.SerializeToCodedStream(&out);
  }
  return bytes;
}

Result<void> RecordReader::Fill(std::size_t count) {
  if (buffer_.size() - begin_ >= count) return {};
  buffer_.erase(0, begin_);
  begin_ = 0;
  while (buffer_.size() < count) {
    const auto more = bytes_.Read(buffer_);
    if (!more) return tl::unexpected(more.error());
    if (!*more) break;
  }
  return {};
}

Result<std::optional<std::size_t>> RecordReader::Size() {
  if (const auto filled = Fill(kMaxVarintBytes); !filled) return tl::unexpected(filled.error());
  if (begin_ == buffer_.size()) return std::optional<std::size_t>();
  std::size_t size = 0;
  for (std::size_t i = 0; i < kMaxVarintBytes; ++i) {
    if (begin_ == buffer_.size()) return Refuse(taken_, "is cut off");
    const auto byte = static_cast<unsigned char>(buffer_[begin_++]);
    size |= static_cast<std::size_t>(byte & 0x7F) << (7 * i);
    if ((byte & 0x80) == 0) return std::optional(size);
  }
  return Refuse(taken_, "has no size: this is no segment file");
}

Result<std::optional<segments::Record>> RecordReader::Next() {
  const auto size = Size();
  if (!size) return tl::unexpected(size.error());
  if (!*size) return std::optional<segments::Record>();
  if (**size > kMaxRecordBytes) {
    return Refuse(
        taken_, fmt::format("says that it has {} bytes; {} is the limit", **size, kMaxRecordBytes));
  }
  if (const auto filled = Fill(**size); !filled) return tl::unexpected(filled.error());
  if (buffer_.size() - begin_ < **size) return Refuse(taken_, "is cut off");
  segments::Record record;
  const google::protobuf::LogSilencer silence;  // who reads is told by the Result
  if (!record.ParseFromArray(buffer_.data() + begin_, static_cast<int>(**size))) {
    return Refuse(taken_, "is no record of a segment file");
  }
  begin_ += **size;
  ++taken_;
  return std::optional(std::move(record));
}

}  // namespace conav
