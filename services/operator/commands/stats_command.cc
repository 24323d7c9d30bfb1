#include "operator/commands/stats_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "common/console/console.h"
#include "common/runtime/file.h"
#include "common/runtime/sha256.h"
#include "operator/statistics/report.h"

namespace conav::statistics {
namespace {

constexpr const char* kProgram = "conav stats";

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

Result<void> WriteAll(const StatsArguments& arguments, const Analysis& analysis) {
  const std::string tables = ReportText(analysis);
  if (arguments.json == "-" || arguments.html == "-") {
    fmt::print(stderr, "{}", tables);
  } else if (auto printed = WriteStandardOutput(tables); !printed) {
    return printed;
  }
  if (auto written = WriteJsonOutput(arguments.json, ReportJson(analysis)); !written) {
    return written;
  }
  return WriteOutput(arguments.html, ReportPage(analysis));
}

}  // namespace

int RunStats(const StatsArguments& arguments) {
  if (arguments.json == "-" && arguments.html == "-") {
    return Refused(kProgram, "only one of --json and --html can go to standard output");
  }
  const int code = CheckFiles(kProgram, {{"FILE", arguments.data}},
                              {{"--json", arguments.json}, {"--html", arguments.html}});
  if (code != 0) return code;
  const auto analysis = AnalyseFile(arguments);
  if (!analysis) return Failed(kProgram, analysis.error());
  return ExitCode(kProgram, WriteAll(arguments, *analysis));
}

}  // namespace conav::statistics
