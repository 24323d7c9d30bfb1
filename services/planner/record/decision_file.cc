#include "planner/record/decision_file.h"

#include <fmt/format.h>

#include "common/runtime/file.h"
#include "common/segments/record_stream.h"
#include "planner/record/decision_records.h"

namespace conav::planner {
namespace {

constexpr std::string_view kKind = "decision file";

tl::unexpected<Error> Refuse(const std::string& reason) {
  return Fail(ErrorCode::kMalformed, reason);
}

Result<void> ReadHeader(RecordReader& reader) {
  decisions::Record record;
  const auto more = reader.Next(record);
  if (!more) return tl::unexpected(more.error());
  if (!*more || !record.has_header()) {
    return Refuse("it does not begin with a header: this is no decision file");
  }
  const std::uint32_t version = record.header().schema_version();
  if (version == kDecisionSchemaVersion) return {};
  return Refuse(
      fmt::format("schema version {}; this program reads {}", version, kDecisionSchemaVersion));
}

Result<void> ReadRecords(std::string_view frames,
                         const std::function<void(DecisionRecord&&)>& take) {
  RecordReader reader(frames, kKind);
  if (auto header = ReadHeader(reader); !header) return header;
  decisions::Record record;
  for (std::size_t number = 1;; ++number) {
    const auto more = reader.Next(record);
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
    auto decision = ToDomain(record.decision());
    if (!decision) return Refuse(fmt::format("record {}: {}", number, decision.error().text));
    take(*std::move(decision));
  }
}

Result<bool> ReadFrames(std::string_view file, const std::function<void(DecisionRecord&&)>& take) {
  if (file.empty()) return Refuse("it is empty");
  const auto frames = FindFrames(file);
  if (!frames) return tl::unexpected(frames.error());
  if (frames->complete_bytes == 0) return Refuse("it has no complete zstd frame");
  return ReadRecords(file.substr(0, frames->complete_bytes), take).map([&] {
    return frames->torn;
  });
}

template <class T>
Result<T> WithPath(const std::filesystem::path& path, Result<T> result) {
  if (result) return result;
  return Fail(result.error().code, fmt::format("{}: {}", path.string(), result.error().text));
}

}  // namespace

Result<bool> ReadDecisions(const std::filesystem::path& path,
                           const std::function<void(DecisionRecord&&)>& take) {
  const auto file = ReadFile(path);
  if (!file) return tl::unexpected(file.error());
  return WithPath(path, ReadFrames(*file, take));
}

Result<void> CheckHeader(const std::filesystem::path& path, std::string_view frames) {
  RecordReader reader(frames, kKind);
  return WithPath(path, ReadHeader(reader));
}

}  // namespace conav::planner
