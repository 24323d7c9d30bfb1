#include "operator/commands/stats_command.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "common/runtime/file.h"
#include "common/runtime/sha256.h"
#include "operator/statistics/report.h"

namespace conav::statistics {
namespace {

int Failed(const Error& error) {
  fmt::print(stderr, "conav stats: {}\n", error.text);
  return 1;
}

/// Both exist, or would, in one place.
bool SameFile(const std::filesystem::path& a, const std::filesystem::path& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code ignored;
  return std::filesystem::equivalent(a, b, ignored) ||
         std::filesystem::absolute(a).lexically_normal() ==
             std::filesystem::absolute(b).lexically_normal();
}

/// 0, or 2 after a message: nothing that is written may replace something else.
int CheckUse(const StatsArguments& arguments) {
  if (SameFile(arguments.json, arguments.html)) {
    fmt::print(stderr, "conav stats: --json and --html both go to {}\n", arguments.json.string());
    return 2;
  }
  for (const auto& path : {arguments.json, arguments.html}) {
    if (path != "-" && SameFile(path, arguments.data)) {
      fmt::print(stderr, "conav stats: {} is the data; write to another file\n", path.string());
      return 2;
    }
  }
  return 0;
}

/// Before the work rather than after it.
Result<void> CheckOutputs(const StatsArguments& arguments) {
  for (const auto& path : {arguments.json, arguments.html}) {
    if (path.empty() || path == "-") continue;
    if (const auto checked = CheckWritable(path); !checked) return checked;
  }
  return {};
}

Result<Analysis> AnalyseFile(const StatsArguments& arguments) {
  const auto bytes = ReadFile(arguments.data);
  if (!bytes) return tl::unexpected(bytes.error());
  auto file = ParseTable(*bytes, arguments.data.string());
  if (!file) return tl::unexpected(file.error());
  Analysis analysis = Analyse(std::move(*file), arguments.alpha);
  analysis.file = arguments.data.filename().string();
  analysis.sha256 = Sha256Hex(*bytes);
  return analysis;
}

Result<void> Print(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  return Fail(ErrorCode::kIo, fmt::format("standard output: {}", std::strerror(errno)));
}

Result<void> Write(const std::filesystem::path& path, const std::string& text) {
  if (path.empty()) return {};
  return path == "-" ? Print(text) : WriteFile(path, text);
}

Result<void> WriteAll(const StatsArguments& arguments, const Analysis& analysis) {
  const std::string tables = ReportText(analysis);
  if (arguments.json == "-" || arguments.html == "-") {
    fmt::print(stderr, "{}", tables);
  } else if (auto printed = Print(tables); !printed) {
    return printed;
  }
  if (auto written = Write(arguments.json, ReportJson(analysis).dump(2) + "\n"); !written) {
    return written;
  }
  return Write(arguments.html, ReportPage(analysis));
}

}  // namespace

int RunStats(const StatsArguments& arguments) {
  if (const int code = CheckUse(arguments); code != 0) return code;
  if (const auto checked = CheckOutputs(arguments); !checked) return Failed(checked.error());
  const auto analysis = AnalyseFile(arguments);
  if (!analysis) return Failed(analysis.error());
  const auto written = WriteAll(arguments, *analysis);
  return written ? 0 : Failed(written.error());
}

}  // namespace conav::statistics
