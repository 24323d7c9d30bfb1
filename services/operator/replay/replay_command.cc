#include "operator/replay/replay_command.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/console/console.h"
#include "common/console/progress_line.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/stop_token.h"
#include "operator/bag/run_recording.h"
#include "operator/replay/recording_reader.h"
#include "operator/replay/replay_server.h"

namespace conav::operators {
namespace {

constexpr const char* kProgram = "conav replay";

std::string Summary(const std::filesystem::path& file, const Timeline& timeline) {
  const auto count = [&](console::MarkKind kind) {
    return std::ranges::count(timeline.marks, kind, &console::Mark::kind);
  };
  return fmt::format("{}: {}, pictures {}, edits {}, paths and answers {}, alerts {}, goals {}\n",
                     file.string(), DurationText(timeline.duration_s), count(console::MARK_PICTURE),
                     count(console::MARK_EDIT), count(console::MARK_GUIDANCE),
                     count(console::MARK_ALERT), count(console::MARK_GOAL));
}

GatewayOptions OptionsOf(const ReplayArguments& arguments) {
  GatewayOptions options;
  options.port = arguments.port;
  options.web = arguments.web.string();
  options.message_rate = 500.0;  // a slider that is dragged tells each place
  options.message_burst = 2000;
  return options;
}

Result<void> Serve(const ReplayArguments& arguments, const std::string& summary,
                   const Timeline& timeline) {
  const SteadyClock clock;
  ReplayServer server(timeline, OptionsOf(arguments), clock);
  if (!arguments.url_file.empty()) {
    if (auto written = WriteFile(arguments.url_file, server.url() + "\n"); !written) return written;
  }
  const std::string invitation = fmt::format("Open {} to see it. Ctrl-C ends it.\n", server.url());
  if (auto printed = WriteStandardOutput(summary + invitation); !printed) return printed;
  server.Run(ProcessStopToken());
  return {};
}

}  // namespace

int RunReplay(const ReplayArguments& arguments) {
  log::SetService("replay");
  log::SetMinimumLevel(log::Level::kWarning);
  InstallStopSignals();
  const auto file = bag::RecordingOf(arguments.run);
  if (!file) return Failed(kProgram, file.error());
  const int code = CheckFiles(kProgram, {{"RUN", *file}}, {{"--url-file", arguments.url_file}});
  if (code != 0) return code;
  const auto run = ReadRun(*file);
  if (!run) return Failed(kProgram, run.error());
  for (const std::string& warning : run->warnings) {
    Warn(kProgram, fmt::format("{}: {}", file->string(), warning));
  }
  try {
    return ExitCode(kProgram, Serve(arguments, Summary(*file, run->timeline), run->timeline));
  } catch (const StartupError& error) {
    return Failed(kProgram, {ErrorCode::kUnavailable, error.what()});
  }
}

}  // namespace conav::operators
