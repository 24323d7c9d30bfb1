#include "common/segments/segment_log.h"

#include <fmt/core.h>
#include <segments.pb.h>

#include "common/runtime/log.h"
#include "common/segments/record_stream.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_file.h"

namespace conav {

Result<FrameLog> FrameLog::Open(const std::filesystem::path& path, const Check& check) {
  return AppendedFile::Continue(path).and_then([&](AppendedFile&& file) -> Result<FrameLog> {
    FrameLog log(std::move(file));
    return log.Begin(check).map([&] { return std::move(log); });
  });
}

Result<void> FrameLog::Begin(const Check& check) {
  const auto bytes = ReadFile(file_.path());
  if (!bytes) return tl::unexpected(bytes.error());
  const auto refuse = [&](const Error& error) {
    return Error{error.code, fmt::format("{}: {}", file_.path().string(), error.text)};
  };
  const auto frames = FindFrames(*bytes).map_error(refuse);
  if (!frames) return tl::unexpected(frames.error());
  const std::size_t size = frames->complete_bytes;
  if (frames->torn && size == 0) {
    return tl::unexpected(
        refuse({ErrorCode::kMalformed, "it ends inside of its first zstd frame"}));
  }
  if (size > 0) {
    if (auto checked = check(std::string_view(*bytes).substr(0, size)); !checked) return checked;
  }
  if (!frames->torn) return {};
  return SetAside(std::string_view(*bytes).substr(size)).and_then([&] {
    return file_.CutTo(size);
  });
}

Result<void> FrameLog::SetAside(std::string_view torn_end) const {
  std::filesystem::path aside = file_.path();
  aside += ".torn";
  return WriteFile(aside, ReadFile(aside).value_or("").append(torn_end)).map([&] {
    LOG_WARNING("torn end of a recording set aside", "file", file_.path().string(), "bytes",
                torn_end.size(), "kept_in", aside.string());
  });
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
