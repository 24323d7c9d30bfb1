#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/runtime/config.h"

namespace conav::recorder {

/// Section `recorder:` of a config file.
struct RecorderConfig {
  bus::ParticipantOptions bus;
  /// "world/robot" of every robot that is recorded; the topics of their worlds and those of the
  /// system are, too.
  std::vector<std::string> robots{"w1/r1"};
  /// MCAP file; its folder must exist. Where the file does, a recorder that starts again goes on in
  /// the next one: recording-2.mcap.
  std::string file = "recording.mcap";
  /// Goes on in the next file when this one is so large, MiB; 0 = never.
  double max_file_mib = 0.0;
  /// The same when this file's index, which is kept in memory, is so large; 1 MiB lasts about 20
  /// minutes with 16 robots.
  double max_index_mib = 64.0;
  /// Removes the oldest files beyond this number; 0 = none.
  int keep_files = 0;
  /// Record the pictures that cameras stream, too.
  bool streams = false;
  /// Record clock, odometry and transforms as often as they come, and ask the simulator for its full
  /// rate; else one per 0.25 s of their time.
  bool full_rate = false;
  /// Topics that are not recorded, as "/r1/odom", or as "/{}/odom" for every robot or world.
  std::vector<std::string> exclude;
  /// Further facts of the run, written into the file as they are.
  std::map<std::string, std::string> facts;

  void Visit(ConfigReader& reader) {
    reader.Section("bus", bus);
    reader.Field("robots", robots);
    reader.Field("file", file);
    reader.Field("max_file_mib", max_file_mib, 0.0, 1e6);
    reader.Field("max_index_mib", max_index_mib, 0.001, 1e5);
    reader.Field("keep_files", keep_files, 0, 500);  // a reader opens all of them
    reader.Field("streams", streams);
    reader.Field("full_rate", full_rate);
    reader.Field("exclude", exclude);
    reader.Field("facts", facts);
  }
};

}  // namespace conav::recorder
