#include "study/episode_player.h"

#include <cstdio>
#include <exception>
#include <utility>

#include "launcher/demo.h"

namespace conav::study {
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
