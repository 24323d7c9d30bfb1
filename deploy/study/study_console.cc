#include "study/study_console.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>

#include "common/console/console.h"

namespace conav::study {

StudyListener ShowOn(ProgressLine& line, const std::string& pieces) {
  const auto start = std::chrono::steady_clock::now();
  return [&line, pieces, start](const StudyProgress& now) {
    const double spent =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double left =
        spent / static_cast<double>(now.ran) * static_cast<double>(now.of - now.done);
    const std::string failed = now.failed > 0 ? fmt::format(", {} failed", now.failed) : "";
    line.Show(fmt::format("{} of {} {}{}, {} left", now.done, now.of, pieces, failed,
                          DurationText(left)));
  };
}

Result<void> PrintTables(const std::string& text, const std::filesystem::path& json_file) {
  if (json_file != "-") return WriteStandardOutput(text);
  std::fputs(text.c_str(), stderr);
  return {};
}

int RefusedFolder(std::string_view program, const Error& error) {
  return error.code == ErrorCode::kRefused ? Refused(program, "--out " + error.text)
                                           : Failed(program, error);
}

int Interrupted(std::string_view program, std::size_t done, std::size_t of,
                const std::string& pieces, const StudyFolder& folder) {
  return Failed(program,
                {ErrorCode::kUnavailable,
                 fmt::format("interrupted; {} of {} {} are in {}; the same command goes on", done,
                             of, pieces, folder.path().string())});
}

}  // namespace conav::study
