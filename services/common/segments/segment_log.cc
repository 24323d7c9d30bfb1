#include "common/segments/segment_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "common/runtime/demand.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/segments/record_stream.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_records.h"

namespace conav {

SegmentLog::SegmentLog(std::filesystem::path path, int file)
    : path_(std::move(path)), file_(file) {}

SegmentLog::SegmentLog(SegmentLog&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      size_(other.size_),
      trajectories_(other.trajectories_),
      newest_(std::move(other.newest_)) {}

SegmentLog::~SegmentLog() {
  if (file_ >= 0) ::close(file_);
}

Error SegmentLog::Failure(const std::string& what) const {
  return {ErrorCode::kIo, fmt::format("{}: {}: {}", path_.string(), what, std::strerror(errno))};
}

Result<SegmentLog> SegmentLog::Open(const std::filesystem::path& path) {
  SegmentLog log(path, ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644));
  if (log.file_ < 0) return tl::unexpected(log.Failure("cannot record"));
  if (::flock(log.file_, LOCK_EX | LOCK_NB) != 0) {
    return Fail(ErrorCode::kUnavailable,
                fmt::format("{}: another process records to it", path.string()));
  }
  return log.Begin().map([&] { return std::move(log); });
}

Result<void> SegmentLog::Begin() {
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
  if (frames->complete_bytes > 0) {
    const auto set = ReadSegmentFile(path_, TornEnd::kDrop);
    if (!set) return tl::unexpected(set.error());
    trajectories_ = static_cast<std::uint32_t>(set->trajectories.size());
  }
  size_ = frames->complete_bytes;
  if (frames->torn) return SetAside(std::string_view(*bytes).substr(size_));
  if (size_ > 0) return {};
  ZstdFrame frame;
  frame.Add(Delimited(HeaderRecord()));
  return Write(frame.Finish());
}

Result<void> SegmentLog::SetAside(std::string_view torn_end) {
  std::filesystem::path aside = path_;
  aside += ".torn";
  const auto kept = WriteFile(aside, ReadFile(aside).value_or("").append(torn_end));
  if (!kept) return kept;
  if (::ftruncate(file_, static_cast<off_t>(size_)) != 0) {
    return tl::unexpected(Failure("cannot cut away its torn end"));
  }
  LOG_WARNING("torn end of a recording set aside", "file", path_.string(), "bytes", torn_end.size(),
              "kept_in", aside.string());
  return {};
}

Result<void> SegmentLog::Write(const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const auto written = ::write(file_, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const Error failure = Failure("cannot write");
      // What was not cut away here, the next Open() cuts away.
      [[maybe_unused]] const int cut = ::ftruncate(file_, static_cast<off_t>(size_));
      return tl::unexpected(failure);
    }
    done += static_cast<std::size_t>(written);
  }
  size_ += bytes.size();
  return {};
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
  return Write(frame.Finish()).map([&] {
    newest_.insert_or_assign(number, segment);
    if (number == trajectories_) ++trajectories_;
  });
}

}  // namespace conav
