#include "common/segments/segment_log.h"

#include "common/runtime/demand.h"
#include "common/segments/record_stream.h"
#include "common/segments/segment_checks.h"
#include "common/segments/segment_file.h"
#include "common/segments/segment_records.h"

namespace conav {

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
