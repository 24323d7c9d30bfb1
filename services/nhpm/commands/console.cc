#include "nhpm/commands/console.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "common/runtime/file.h"
#include "common/runtime/json.h"

namespace conav::nhpm {

int Failed(std::string_view program, const Error& error) {
  std::fputs(fmt::format("{}: {}\n", program, error.text).c_str(), stderr);
  return 1;
}

void Warn(std::string_view program, const std::string& text) {
  std::fputs(fmt::format("{}: warning: {}\n", program, text).c_str(), stderr);
}

std::string UnknownLearning(const std::filesystem::path& weights) {
  return fmt::format(
      "{}: does not name the trajectories that it learned from, as weights of before conav train "
      "kept them: it may have seen what it is tested on",
      weights.string());
}

int ExitCode(std::string_view program, const Result<void>& done) {
  return done ? 0 : Failed(program, done.error());
}

Result<void> WriteStandardOutput(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  return Fail(ErrorCode::kIo,
              fmt::format("standard output: cannot write: {}", std::strerror(errno)));
}

Result<void> WriteOutput(const std::filesystem::path& path, std::string_view text) {
  if (path.empty()) return {};
  return path == "-" ? WriteStandardOutput(text) : WriteFile(path, text);
}

Result<void> WriteJsonOutput(const std::filesystem::path& path,
                             const nlohmann::ordered_json& document) {
  return WriteOutput(path, JsonText(document));
}

Result<void> CheckOutputs(std::initializer_list<std::filesystem::path> paths) {
  for (const std::filesystem::path& path : paths) {
    if (path.empty() || path == "-") continue;
    if (const auto checked = CheckWritable(path); !checked) return checked;
  }
  return {};
}

}  // namespace conav::nhpm
