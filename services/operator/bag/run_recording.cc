#include "operator/bag/run_recording.h"

#include <fmt/format.h>

namespace conav::bag {

Result<std::filesystem::path> RecordingOf(const std::filesystem::path& run) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(run, ignored)) return run;
  const std::filesystem::path file = run / "recording.mcap";
  if (std::filesystem::exists(file, ignored)) return file;
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: no recording.mcap in it: no run folder, or it ran with "
                          "--no-recording",
                          run.string()));
}

}  // namespace conav::bag
