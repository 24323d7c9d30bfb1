#pragma once

#include <filesystem>
#include <optional>

#include "common/runtime/clock.h"
#include "common/runtime/stop_token.h"
#include "launcher/demo_options.h"
#include "launcher/domain_lease.h"
#include "study/design.h"
#include "study/episode_record.h"
#include "study/study_folder.h"

namespace conav::study {

/// The episode as a demo: all services as processes of their own. `base` says what all episodes
/// have in common: robots, camera, vendors, limits.
launcher::DemoOptions DemoFor(const launcher::DemoOptions& base, const PlannedEpisode& episode,
                              const std::string& subject, const StudyFolder& folder);

/// Runs episodes one after the other in a DDS domain that it keeps.
class DemoPlayer {
 public:
  /// `clock` and `stop` outlive it.
  DemoPlayer(std::filesystem::path program_folder, const Clock& clock, const StopToken& stop);

  /// Blocks. Whatever goes wrong is in the record.
  EpisodeRecord Play(const launcher::DemoOptions& options);

 private:
  std::filesystem::path program_folder_;
  const Clock& clock_;
  const StopToken& stop_;
  std::optional<launcher::DomainLease> lease_;
};

}  // namespace conav::study
