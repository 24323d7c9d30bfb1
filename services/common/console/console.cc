#include "common/console/console.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "common/runtime/file.h"
#include "common/runtime/json.h"

namespace conav {

int Failed(std::string_view program, const Error& error) {
  std::fputs(fmt::format("{}: {}\n", program, error.text).c_str(), stderr);
  return 1;
}

int Refused(std::string_view program, const std::string& reason) {
  Failed(program, {ErrorCode::kInvalidArgument, reason});
  return 2;
}

void Warn(std::string_view program, const std::string& text) {
  std::fputs(fmt::format("{}: warning: {}\n", program, text).c_str(), stderr);
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

int CheckFiles(std::string_view program, const std::vector<FileOption>& inputs,
               const std::vector<FileOption>& outputs) {
  if (const auto distinct = CheckDistinct(inputs, outputs); !distinct) {
    return Refused(program, distinct.error().text);
  }
  for (const auto& [option, path] : outputs) {
    if (path.empty() || path == "-") continue;
    if (const auto writable = CheckWritable(path); !writable) {
      return Refused(program, fmt::format("{} {}", option, writable.error().text));
    }
  }
  return 0;
}

}  // namespace conav
