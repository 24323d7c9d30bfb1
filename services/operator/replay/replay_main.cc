#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/runtime/clock.h"
#include "common/runtime/file.h"
#include "common/runtime/log.h"
#include "common/runtime/threads.h"
#include "operator/gateway/gateway.h"
#include "operator/gateway/page_feed.h"
#include "operator/recording/mcap_file.h"
#include "operator/replay/timeline.h"

namespace conav::operators {
namespace {

constexpr std::chrono::milliseconds kPeriod{30};

console::Welcome MakeWelcome() {
  console::Welcome welcome;
  welcome.set_mode(console::MODE_REPLAY);
  return welcome;
}

/// Shows a timeline on the console's page: all pages see the same place of it, and each may go to
/// another one. It begins to play when the first page comes. Other requests of pages are refused.
/// Threads: one.
class ReplayServer {
 public:
  /// `timeline` and `clock` outlive it. Throws StartupError as Gateway does.
  ReplayServer(const Timeline& timeline, const GatewayOptions& options, const Clock& clock)
      : clock_(clock),
        snapshots_(options.image_bytes()),
        player_(timeline, {updates_, frames_, snapshots_}, WallSeconds()),
        stepped_at_(clock.Now()) {
    gateway_.emplace(options, Gateway::Shared{updates_, frames_, snapshots_}, MakeWelcome(),
                     [this] {
                       const std::lock_guard lock(mutex_);
                       woken_ = true;
                       wake_.notify_one();
                     });
  }

  /// Blocks until `stop`.
  void Run(const StopToken& stop) {
    while (!stop.stop_requested()) {
      Wait();
      Step();
    }
  }
  std::string url() const { return gateway_->url(); }

 private:
  void Wait() {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, kPeriod, [this] { return woken_; });
    woken_ = false;
  }

  void Step() {
    const double elapsed_s =
        std::chrono::duration<double>(clock_.Now() - std::exchange(stepped_at_, clock_.Now()))
            .count();
    player_.Advance(elapsed_s, WallSeconds());
    for (const PageEvent& event : gateway_->Take()) Take(event);
    if (position_s_ || speed_) player_.Seek(position_s_, speed_, WallSeconds());
    position_s_.reset();
    speed_.reset();
    gateway_->SetReadiness({true, "{\"ready\":true,\"message\":\"a recording\"}\n"});
    gateway_->Notify();
  }

  void Take(const PageEvent& event) {
    if (const auto* seek = std::get_if<console::Seek>(&event.body)) {
      if (seek->has_position()) position_s_ = seek->position();
      if (seek->has_speed()) speed_ = seek->speed();
    } else if (const auto* asked = std::get_if<PageAsked>(&event.body)) {
      console::Reply reply;
      reply.set_id(asked->request.id());
      reply.set_reason("this is a recording");
      gateway_->Send(event.page, reply);
    } else if (std::holds_alternative<PageJoined>(event.body)) {
      presence_.Join(event.page, event.who);
      if (!std::exchange(was_seen_, true)) speed_ = 1.0;
      player_.Receive(presence_.People());
    } else {
      presence_.Leave(event.page, clock_.Now());
      player_.Receive(presence_.People());
    }
  }

  const Clock& clock_;
  UpdateLog updates_;
  FrameSlots frames_;
  SnapshotStore snapshots_;
  ReplayPlayer player_;
  Clock::TimePoint stepped_at_;
  /// Of the seeks that came since the last step: only where they end counts.
  std::optional<double> position_s_;
  std::optional<double> speed_;
  bool was_seen_ = false;
  PagePresence presence_;
  std::mutex mutex_;  // guards woken_
  std::condition_variable wake_;
  bool woken_ = false;
  std::optional<Gateway> gateway_;
};

/// Arguments of `conav replay`.
struct ReplayArguments {
  std::filesystem::path run;       // run folder or MCAP file
  int port = 8080;                 // 0 = any that is free
  std::filesystem::path url_file;  // empty = none
  std::filesystem::path web;       // folder of the page; empty = the one next to the program
};

constexpr const char* kProgram = "conav replay";

std::string Summary(const std::filesystem::path& file, const Timeline& timeline) {
  const auto count = [&](console::MarkKind kind) {
    return std::ranges::count(timeline.marks, kind, &console::Mark::kind);
  };
  return fmt::format(
      "{}: {}, pictures {}, edits {}, paths and answers {}, alerts {}, goals {}\n", file.string(),
      DurationText(timeline.duration_s), count(console::MARK_SNAPSHOT), count(console::MARK_EDIT),
      count(console::MARK_GUIDANCE), count(console::MARK_ALERT), count(console::MARK_GOAL));
}

GatewayOptions OptionsOf(const ReplayArguments& arguments) {
  GatewayOptions options;
  options.port = arguments.port;
  options.web = arguments.web.string();
  options.message_rate = 500.0;  // a dragged slider sends every position
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

/// Serves the console on the recording until SIGINT or SIGTERM; prints its address on standard
/// output. Exit code: 0 ended so, 1 failed, 2 wrong use.
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

}  // namespace
}  // namespace conav::operators

// conav-replay: a recorded run in the console's page.

namespace {

constexpr const char* kAbout =
    R"(Shows a recorded run in the console's page: play, pause, go to any time, picture, edit or alert.
The true map, which nobody knew during the run, is a layer of its own.

RUN is a run folder (./conav demo leaves runs/<time>-seed<S>) or an MCAP file. A recording that was cut
off (its process was killed, the disk was full, or it is still being written) is played up to its
end, with a warning. docs/console.md says more.

Exit codes: 0 ended by Ctrl-C; 1 RUN holds no recording, or one that cannot be read, or the port is taken; 2
wrong use, or no such RUN.

Examples:
  conav replay runs/20261121-172744-seed7
  conav replay runs/20261121-172744-seed7 --port 0)";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, "conav replay");
  conav::operators::ReplayArguments arguments;
  app.add_option("run", arguments.run, "The run")->required()->type_name("RUN");
  app.add_option("--port", arguments.port,
                 "Port of the page on this machine; 0 = any that is free (default 8080)")
      ->check(conav::Between(0, 65535));
  app.add_option("--url-file", arguments.url_file, "Write the page's address to this file")
      ->type_name("FILE");
  app.add_option("--web", arguments.web, "Folder of another page than the one that was built")
      ->type_name("DIR");
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return conav::operators::RunReplay(arguments);
}
