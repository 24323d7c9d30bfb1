#include "planner/record/decision_log.h"

#include "common/segments/record_stream.h"
#include "planner/record/decision_file.h"
#include "planner/record/decision_records.h"

namespace conav::planner {
namespace {

constexpr int kCompressionLevel = 3;  // a robot waits for it

std::string FrameOf(const decisions::Record& record) {
  ZstdFrame frame(kCompressionLevel);
  frame.Add(Delimited(record));
  return frame.Finish();
}

}  // namespace

Result<DecisionLog> DecisionLog::Open(const std::filesystem::path& path) {
  auto opened =
      FrameLog::Open(path, [&](std::string_view frames) { return CheckHeader(path, frames); });
  if (!opened) return tl::unexpected(opened.error());
  DecisionLog log(*std::move(opened));
  if (!log.log_.empty()) return log;
  return log.log_.Append(FrameOf(HeaderRecord())).map([&] { return std::move(log); });
}

Result<void> DecisionLog::Append(const DecisionRecord& decision) {
  return log_.Append(FrameOf(ToRecord(decision)));
}

}  // namespace conav::planner
