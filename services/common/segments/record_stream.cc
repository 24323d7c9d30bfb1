#include "common/segments/record_stream.h"

#include <fmt/core.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/stubs/logging.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <new>

namespace conav {
namespace {

constexpr int kMaxWindowLog = 24;  // 16 MiB
constexpr std::size_t kChunkBytes = std::size_t{64} * 1024;

// The first bytes of every frame, little-endian 0xFD2FB528.
constexpr std::string_view kMagic = "\x28\xB5\x2F\xFD";

bool CanBeginFrame(std::string_view bytes) {
  const std::size_t known = std::min(bytes.size(), kMagic.size());
  return bytes.substr(0, known) == kMagic.substr(0, known);
}

/// Whether `rest`, for which zstd returned `error`, is the beginning of one frame and nothing else.
/// A damaged frame may also seem to extend past the end of the file, over the frames that follow
/// it.
bool IsTorn(std::string_view rest, std::size_t error) {
  return ZSTD_getErrorCode(error) == ZSTD_error_srcSize_wrong &&
         rest.find(kMagic, kMagic.size()) == std::string_view::npos;
}

/// Demands success of calls that only fail through our own mistake or lack of memory.
std::size_t Must(std::size_t code) {
  DEMAND(ZSTD_isError(code) == 0, ZSTD_getErrorName(code));
  return code;
}

constexpr std::size_t kMaxRecordBytes = std::size_t{32} * 1024 * 1024;
constexpr std::size_t kMaxVarintBytes = 5;

tl::unexpected<Error> Refuse(std::size_t record, const std::string& reason) {
  return Fail(ErrorCode::kMalformed, fmt::format("record {} {}", record, reason));
}

}  // namespace

// Writing.

struct ZstdFrame::Context {
  ZSTD_CCtx* handle = ZSTD_createCCtx();
  ~Context() { ZSTD_freeCCtx(handle); }
};

ZstdFrame::ZstdFrame(int level) : context_(std::make_unique<Context>()) {
  if (context_->handle == nullptr) throw std::bad_alloc();
  Must(ZSTD_CCtx_setParameter(context_->handle, ZSTD_c_compressionLevel, level));
  Must(ZSTD_CCtx_setParameter(context_->handle, ZSTD_c_checksumFlag, 1));
}

ZstdFrame::~ZstdFrame() = default;

void ZstdFrame::Run(std::string_view bytes, bool last) {
  ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
  std::size_t left = 0;
  do {
    const std::size_t begin = frame_.size();
    frame_.resize(begin + kChunkBytes);
    ZSTD_outBuffer output{frame_.data() + begin, kChunkBytes, 0};
    left = Must(ZSTD_compressStream2(context_->handle, &output, &input,
                                     last ? ZSTD_e_end : ZSTD_e_continue));
    frame_.resize(begin + output.pos);
  } while (last ? left > 0 : input.pos < input.size);
}

void ZstdFrame::Add(std::string_view bytes) { Run(bytes, false); }

std::string ZstdFrame::Finish() {
  Run({}, true);
  return std::move(frame_);
}

// Reading.

Result<FrameExtent> FindFrames(std::string_view file) {
  FrameExtent extent;
  while (extent.complete_bytes < file.size()) {
    const std::string_view rest = file.substr(extent.complete_bytes);
    const std::size_t size = ZSTD_findFrameCompressedSize(rest.data(), rest.size());
    if (ZSTD_isError(size) == 0) {
      extent.complete_bytes += size;
      continue;
    }
    if (!CanBeginFrame(rest)) {
      return Fail(ErrorCode::kMalformed,
                  extent.complete_bytes == 0
                      ? std::string("it is not compressed with zstd")
                      : fmt::format("it is not zstd data after byte {}", extent.complete_bytes));
    }
    if (!IsTorn(rest, size)) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("it is damaged after byte {}: {}", extent.complete_bytes,
                              ZSTD_getErrorName(size)));
    }
    extent.torn = true;
    break;
  }
  return extent;
}

struct ZstdReader::Context {
  explicit Context(std::string_view frames) : input{frames.data(), frames.size(), 0} {}
  ~Context() { ZSTD_freeDCtx(handle); }
  ZSTD_DCtx* handle = ZSTD_createDCtx();
  ZSTD_inBuffer input;
};

ZstdReader::ZstdReader(std::string_view frames) : context_(std::make_unique<Context>(frames)) {
  if (context_->handle == nullptr) throw std::bad_alloc();
  Must(ZSTD_DCtx_setParameter(context_->handle, ZSTD_d_windowLogMax, kMaxWindowLog));
}

ZstdReader::~ZstdReader() = default;

Result<bool> ZstdReader::Read(std::string& bytes) {
  const std::size_t begin = bytes.size();
  bytes.resize(begin + kChunkBytes);
  ZSTD_outBuffer output{bytes.data() + begin, kChunkBytes, 0};
  std::size_t code = 0;
  // A whole frame, or a part of one, may decompress to no bytes.
  do {
    code = ZSTD_decompressStream(context_->handle, &output, &context_->input);
  } while (ZSTD_isError(code) == 0 && output.pos == 0 &&
           context_->input.pos < context_->input.size);
  bytes.resize(begin + output.pos);
  if (ZSTD_isError(code) != 0) {
    return Fail(ErrorCode::kMalformed, fmt::format("it is damaged at byte {}: zstd says: {}",
                                                   context_->input.pos, ZSTD_getErrorName(code)));
  }
  return output.pos > 0;
}

std::string Delimited(const google::protobuf::MessageLite& record) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream target(&bytes);
    google::protobuf::io::CodedOutputStream out(&target);
    // equal records give equal bytes: fixes the order of maps
    out.SetSerializationDeterministic(true);
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
                  fmt::format("states a size of {} bytes; {} is the limit", size, kMaxRecordBytes));
  }
  if (const auto filled = Fill(size); !filled) return tl::unexpected(filled.error());
  if (buffer_.size() - begin_ < size) return Refuse(taken_, "is cut off");
  const google::protobuf::LogSilencer silence;  // the Result reports the error
  if (!record.ParseFromArray(buffer_.data() + begin_, static_cast<int>(size))) {
    return Refuse(taken_, "is not a record of a " + kind_);
  }
  begin_ += size;
  ++taken_;
  return true;
}

}  // namespace conav
