#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>

namespace conav::launcher {

/// The folder with all inputs and outputs of a run:
///
///   runs/<id>/config/<service>.yaml   effective configuration of each process
///             logs/<service>.log      its stdout and stderr; <service>.log.1: those before (LimitLog)
///             state/                  the operator's database
///             recording.mcap          the messages on the bus (docs/recording.md)
///             segments.pb.zst         the operator's edits after each picture
///             decisions.pb.zst        every decision, for `conav explain`; several planners
///                                     write a file each, decisions-<planner>.pb.zst
///             metrics.json            the result table and its inputs
///             episode.svg             truth, maps, trajectories and pictures
class RunFolder {
 public:
  /// Creates `parent`/<id>/, where <id> is time (UTC) and seed, plus "-2" if it exists already.
  /// Throws StartupError with path and cause.
  RunFolder(const std::filesystem::path& parent, std::chrono::system_clock::time_point now,
            std::uint64_t seed);

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path config(const std::string& service) const;
  std::filesystem::path log(const std::string& service) const;
  std::filesystem::path state() const { return path_ / "state"; }
  /// The file in which the operator service publishes the console's address.
  std::filesystem::path console_url() const { return path_ / "state" / "console.url"; }
  std::filesystem::path foxglove_url() const { return path_ / "state" / "foxglove.url"; }
  std::filesystem::path recording() const { return path_ / "recording.mcap"; }
  std::filesystem::path decisions(const std::string& planner) const;

  /// Writes a text file of this folder. Throws StartupError with path and cause.
  void Write(const std::filesystem::path& file, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

/// Moves the text of a log that is larger than `limit` bytes to <log>.1, which it replaces; its process
/// appends to what is then empty. Lines that come in the middle of this are lost.
void LimitLog(const std::filesystem::path& log, std::uintmax_t limit);

/// "20261121-090531-seed7".
std::string RunId(std::chrono::system_clock::time_point now, std::uint64_t seed);

}  // namespace conav::launcher
