#pragma once

#include <google/protobuf/message_lite.h>

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "common/runtime/result.h"

/// Files of protobuf records, each preceded by its size as a varint, in zstd frames (RFC 8878). A
/// file is a sequence of frames, which decompress to one stream of bytes.
namespace conav {

/// Makes one frame, with a checksum, from bytes that arrive in parts.
class ZstdFrame {
 public:
  explicit ZstdFrame(int level = 9);
  ~ZstdFrame();
  void Add(std::string_view bytes);
  /// The frame. Call once, last.
  std::string Finish();

 private:
  struct Context;
  void Run(std::string_view bytes, bool last);
  std::unique_ptr<Context> context_;
  std::string frame_;
};

/// Where the complete frames of a file end.
struct FrameExtent {
  std::size_t complete_bytes = 0;
  bool torn = false;  // the file ends inside the frame after them
};

/// Follows the frames' block headers without decompressing.
/// Errors: kMalformed when the bytes after the complete frames are not the beginning of one frame,
///         or have frames behind them: then the file is damaged, not torn.
[[nodiscard]] Result<FrameExtent> FindFrames(std::string_view file);

/// Decompresses complete frames piece by piece; `frames` outlives it.
class ZstdReader {
 public:
  explicit ZstdReader(std::string_view frames);
  ~ZstdReader();
  /// Appends up to 64 KiB to `bytes`; false at the end.
  /// Errors: kMalformed (damaged, or made with a window above our limit of 16 MiB).
  [[nodiscard]] Result<bool> Read(std::string& bytes);

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// `record`, preceded by its size as a varint.
std::string Delimited(const google::protobuf::MessageLite& record);

/// Takes records from complete frames, which outlive it.
class RecordReader {
 public:
  /// `kind` of file, for errors: "segment file".
  RecordReader(std::string_view frames, std::string_view kind) : bytes_(frames), kind_(kind) {}

  /// Reads the next record into `record`; false at the end. Errors: kMalformed: damaged, no such
  /// record, cut off, larger than 32 MiB.
  [[nodiscard]] Result<bool> Next(google::protobuf::MessageLite& record);

 private:
  /// Makes `count` bytes available, or fewer at the end of the stream.
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
