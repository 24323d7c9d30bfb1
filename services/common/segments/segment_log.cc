#include "common/segments/segment_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <segments.pb.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/segments/record_stream.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_file.h"

namespace conav {

FrameLog::FrameLog(std::filesystem::path path, int file) : path_(std::move(path)), file_(file) {}

FrameLog::FrameLog(FrameLog&& other) noexcept
    : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)), size_(other.size_) {}

FrameLog::~FrameLog() {
  if (file_ >= 0) ::close(file_);
}

Error FrameLog::Failure(const std::string& what) const {
  return {ErrorCode::kIo, fmt::format("{}: {}: {}", path_.string(), what, std::strerror(errno))};
}

Result<FrameLog> FrameLog::Open(const std::filesystem::path& path, const Check& check) {
  FrameLog log(path, ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  if (log.file_ < 0) return tl::unexpected(log.Failure("cannot record"));
  // Reading a device might never end.
  if (!std::filesystem::is_regular_file(path)) {
    return Fail(ErrorCode::kIo,
                fmt::format("{}: cannot record: it is not a regular file", path.string()));
  }
  if (::flock(log.file_, LOCK_EX | LOCK_NB) != 0) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{}: another process records to it", path.string()));
  }
  return log.Begin(check).map([&] { return std::move(log); });
}

Result<void> FrameLog::Begin(const Check& check) {
  const auto bytes = ReadFile(path_);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto frames = FindFrames(*bytes);
  if (!frames) {
    return Fail(frames.error().code, fmt::format("{}: {}", path_.string(), frames.error().text));
  }
  if (frames->torn && frames->complete_bytes == 0) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: it ends inside of its first zstd frame", path_.string()));
  }
  const std::string_view complete = std::string_view(*bytes).substr(0, frames->complete_bytes);
  if (!complete.empty()) {
    if (auto checked = check(complete); !checked) return checked;
  }
  size_ = complete.size();
  if (!frames->torn) return {};
  return SetAside(std::string_view(*bytes).substr(size_));
}

Result<void> FrameLog::SetAside(std::string_view torn_end) {
  std::filesystem::path aside = path_;
  aside += ".torn";
  const auto kept = WriteFile(aside, ReadFile(aside).value_or("").append(torn_end));
  if (!kept) return kept;
  if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) {
    return tl::unexpected(Failure("cannot truncate its torn end"));
  }
  LOG_WARNING("torn end of a recording set aside", "file", path_.string(), "bytes", torn_end.size(),
              "kept_in", aside.string());
  return {};
}

Result<void> FrameLog::Append(std::string_view frame) {
  for (std::size_t done = 0; done < frame.size();) {
    const auto written = ::write(file_, frame.data() + done, frame.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const Error failure = Failure("cannot write");
      // If this truncation fails, the next Open() repeats it.
      [[maybe_unused]] const int cut = ::ftruncate(file_, static_cast<off_t>(size_));
      return tl::unexpected(failure);
    }
    done += static_cast<std::size_t>(written);
  }
  size_ += frame.size();
  return {};
}

Result<SegmentLog> SegmentLog::Open(const std::filesystem::path& path) {
  std::uint32_t trajectories = 0;
  auto opened = FrameLog::Open(path, [&](std::string_view) {
    return ReadSegmentFile(path, TornEnd::kDrop).map([&](const SegmentSet& set) {
      trajectories = static_cast<std::uint32_t>(set.trajectories.size());
    });
  });
  if (!opened) return tl::unexpected(opened.error());
  SegmentLog log(*std::move(opened));
  log.trajectories_ = trajectories;
  if (!log.log_.empty()) return log;
  ZstdFrame frame;
  frame.Add(Delimited(HeaderRecord()));
  return log.log_.Append(frame.Finish()).map([&] { return std::move(log); });
}

Result<void> SegmentLog::Append(std::uint32_t number, const Trajectory& trajectory,
                                const Segment& segment) {
  const auto before = newest_.find(number);
  DEMAND(number == trajectories_ || before != newest_.end(), number, trajectories_);
  const auto checked =
      CheckTrajectoryFacts(trajectory)
          .and_then([&] { return CheckSegment(segment); })
          .and_then([&] {
            return CheckNextSegment(trajectory.truth,
                                    before == newest_.end() ? nullptr : &before->second, segment);
          });
  if (!checked) return checked;
  ZstdFrame frame;
  frame.Add(Delimited(ToRecord(trajectory, number)));
  frame.Add(Delimited(ToRecord(segment, number)));
  return log_.Append(frame.Finish()).map([&] {
    newest_.insert_or_assign(number, segment);
    if (number == trajectories_) ++trajectories_;
  });
}

}  // namespace conav
