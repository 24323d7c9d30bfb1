#pragma once

#include <google/protobuf/message_lite.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "common/runtime/result.h"
#include "common/segments/zstd_frames.h"

/// Files of records in protobuf, each with its size as a varint before it, in zstd frames.
namespace conav {

/// `record` with its size as a varint before it.
std::string Delimited(const google::protobuf::MessageLite& record);

/// Takes records from complete frames, which outlive it.
class RecordReader {
 public:
  /// `kind` of file, for errors: "segment file".
  RecordReader(std::string_view frames, std::string_view kind) : bytes_(frames), kind_(kind) {}

  /// Reads the next into `record`; false at the end. Errors: kMalformed: damaged, no such record, cut
  /// off, larger than 32 MiB.
  [[nodiscard]] Result<bool> Next(google::protobuf::MessageLite& record);

 private:
  /// Makes `count` bytes available as far as the stream goes.
  Result<void> Fill(std::size_t count);
  /// Reads the size of the next record; false at the end.
  Result<bool> ReadSize(std::size_t& size);

  ZstdReader bytes_;
  std::string kind_;
  std::string buffer_;     // decompressed
  std::size_t begin_ = 0;  // of what was not taken yet
  std::size_t taken_ = 0;  // records
};

}  // namespace conav
