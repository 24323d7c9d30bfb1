#pragma once

#include <segments.pb.h>

#include <optional>
#include <string>

#include "common/runtime/result.h"
#include "common/segments/zstd_frames.h"

namespace conav {

/// `record` with its size as a varint before it.
std::string Delimited(const segments::Record& record);

/// Takes records from the frames of a segment file. `frames` outlives it.
class RecordReader {
 public:
  explicit RecordReader(std::string_view frames) : bytes_(frames) {}

  /// Nothing at the end. Errors: kMalformed: damaged, no record, cut off, larger than 32 MiB.
  [[nodiscard]] Result<std::optional<segments::Record>> Next();

 private:
  /// Makes `count` bytes available as far as the stream goes.
  Result<void> Fill(std::size_t count);
  /// Size of the next record; nothing at the end.
  Result<std::optional<std::size_t>> Size();

  ZstdReader bytes_;
  std::string buffer_;     // decompressed
  std::size_t begin_ = 0;  // of what was not taken yet
  std::size_t taken_ = 0;  // records
};

}  // namespace conav
