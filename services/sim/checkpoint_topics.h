#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/clock.h"
#include "common/runtime/log.h"
#include "sim/world/episode.h"

// One user: the service, which with it would be two things in one file.

namespace conav::sim {

/// The file from which a simulator that was killed goes on: the newest message of each robot's state,
/// goals and map, as it was published, and the time; the newest picture of each robot in a file of its
/// own (FILE.ROBOT). Written before what it holds is published, so that nothing that others know is
/// lost: no goal, no picture, no moment of simulation time.
///
/// A kill of the process cannot tear it; a power cut can (nothing is synced to the disk).
/// Threads: one caller.
class Checkpoint {
 public:
  /// `file`: empty = none is kept. `configuration`: a file of another one is not used.
  Checkpoint(std::filesystem::path file, std::string configuration, const Clock& clock)
      : file_(std::move(file)),
        configuration_(std::move(configuration)),
        clock_(clock),
        failures_logged_(std::chrono::seconds(10)) {}

  /// Writes when a state changed or is due again, and once a second. A failure is logged.
  void Save(const Episode& episode);

  /// A picture that a robot took, before Save() with the state that counts it.
  void Keep(const Snapshot& picture);

  /// Brings an episode that has just begun to where the file left it, and on by the wall time since
  /// then times `speed`, in which its robots stood. False: there is no file, or one that does not
  /// belong here, which is logged.
  bool Restore(Episode& episode, double speed);
  /// The newest pictures of an episode that was restored.
  std::vector<Snapshot> Pictures(const Episode& episode) const;

  /// The run has ended.
  void Remove(const Episode& episode);

 private:
  std::filesystem::path PictureFile(const std::string& robot) const;
  void Write(const std::filesystem::path& file, const std::string& bytes);

  struct RobotPart {
    std::uint64_t version = 0;
    SimTime map_stamp{-1};
    std::string map;  // serialised
  };

  std::filesystem::path file_;
  std::string configuration_;
  const Clock& clock_;
  std::vector<RobotPart> robots_;
  std::optional<Clock::TimePoint> saved_at_;
  std::uint64_t saved_steps_ = 0;
  LogLimit failures_logged_;
};

}  // namespace conav::sim
