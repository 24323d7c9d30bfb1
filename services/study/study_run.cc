#include "study/study_run.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <utility>

#include "common/cli/cli.h"
#include "launcher/demo.h"

namespace conav::study {

Result<void> CheckDomains(int jobs) {
  if (jobs <= 1 || std::getenv("CONAV_DOMAIN") == nullptr) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("--jobs {}: CONAV_DOMAIN leaves one DDS domain for all of them", jobs));
}

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
                 fmt::format("interrupted; {} of {} {} are in {}; the same command resumes", done,
                             of, pieces, folder.path().string())});
}

Result<EpisodeStore> OpenEpisodes(const StudyFolder& folder) {
  return EpisodeStore::Open(folder, "episodes");
}

Result<void> RunEpisodes(const std::vector<PlannedEpisode>& episodes, int jobs,
                         const EpisodePlayer& play, EpisodeStore& store, const StopToken& stop,
                         const StudyListener& listener) {
  std::vector<std::string> names;
  for (const PlannedEpisode& episode : episodes) names.push_back(episode.name);
  const PiecePlayer<EpisodeRecord> play_named = [&](int job, std::size_t index) {
    EpisodeRecord record = play(job, episodes[index]);
    record.name = episodes[index].name;
    return record;
  };
  return RunPieces(names, jobs, play_named, store, stop, listener);
}

namespace {

EpisodeRecord RecordOf(const launcher::DemoResult& result) {
  using launcher::EndReason;
  EpisodeRecord record{.wall_s = result.outcome.wall_s, .run = result.outcome.run_folder};
  const EndReason reason = result.outcome.reason;
  if (reason == EndReason::kProcessDied || reason == EndReason::kInterrupted) {
    record.detail = launcher::OutcomeLine(result.outcome);
    return record;
  }
  record.measures = MeasuresOf(result.metrics);
  record.status = result.all_goals_reached() ? EpisodeStatus::kComplete : EpisodeStatus::kGoalsLeft;
  if (!result.all_goals_reached()) record.detail = launcher::OutcomeLine(result.outcome);
  return record;
}

}  // namespace

launcher::DemoOptions DemoFor(const launcher::DemoOptions& base, const PlannedEpisode& episode,
                              const std::string& subject, const StudyFolder& folder) {
  launcher::DemoOptions options = base;
  options.headless = true;
  options.method = episode.method;
  options.seed = episode.seed;
  options.maze_seed = episode.maze_seed;
  options.rotation_deg = episode.rotation_deg;
  options.simulated_operator = folder.person(subject).string();
  options.out = folder.runs(episode.name);
  return options;
}

DemoPlayer::DemoPlayer(std::filesystem::path program_folder, const Clock& clock,
                       const StopToken& stop)
    : program_folder_(std::move(program_folder)), clock_(clock), stop_(stop) {}

EpisodeRecord DemoPlayer::Play(const launcher::DemoOptions& options) {
  try {
    launcher::Progress silent(stderr, launcher::Progress::Style::kSilent, clock_);
    std::optional<launcher::DomainLease> kept;
    if (lease_) kept.emplace(*std::move(lease_));
    lease_.reset();
    launcher::Demo demo(options, program_folder_, clock_, silent, std::move(kept));
    const EpisodeRecord record = RecordOf(demo.Run(stop_));
    lease_.emplace(demo.TakeLease());
    return record;
  } catch (const std::exception& error) {
    return {.detail = error.what()};
  }
}

}  // namespace conav::study
