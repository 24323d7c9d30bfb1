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

std::string Delimited(const google::protobuf::MessageLite& record) {
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

Result<bool> RecordReader::ReadSize(std::size_t& size) {
  if (const auto filled = Fill(kMaxVarintBytes); !filled) return tl::unexpected(filled.error());
  if (begin_ == buffer_.size()) return false;
  size = 0;
  for (std::size_t i = 0; i < kMaxVarintBytes; ++i) {
    if (begin_ == buffer_.size()) return Refuse(taken_, "is cut off");
    const auto byte = static_cast<unsigned char>(buffer_[begin_++]);
    size |= static_cast<std::size_t>(byte & 0x7F) << (7 * i);
    if ((byte & 0x80) == 0) return true;
  }
  return Refuse(taken_, "has no size: this is no " + kind_);
}

Result<bool> RecordReader::Next(google::protobuf::MessageLite& record) {
  std::size_t size = 0;
  const auto more = ReadSize(size);
  if (!more || !*more) return more;
  if (size > kMaxRecordBytes) {
    return Refuse(taken_,
                  fmt::format("says that it has {} bytes; {} is the limit", size, kMaxRecordBytes));
  }
  if (const auto filled = Fill(size); !filled) return tl::unexpected(filled.error());
  if (buffer_.size() - begin_ < size) return Refuse(taken_, "is cut off");
  const google::protobuf::LogSilencer silence;  // who reads is told by the Result
  if (!record.ParseFromArray(buffer_.data() + begin_, static_cast<int>(size))) {
    return Refuse(taken_, "is no record of a " + kind_);
  }
  begin_ += size;
  ++taken_;
  return true;
}

}  // namespace conav
