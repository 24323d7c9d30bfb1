#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "operator/recording/mcap_reader.h"

// One user: conav-bag; the export is tested without it.

namespace conav::bag {

/// Writes all messages of a recording as a rosbag2 folder:
///
///   FOLDER/metadata.yaml     version 5
///          <name>_0.db3      SQLite; times are log times, QoS that of the channels' metadata
///
/// `progress` is called now and then with the number of messages written so far. Damaged chunks are
/// left out. After an error nothing of the folder is left.
/// Gives what is wrong with the chunks that were left out, in words.
/// Errors: kRefused: the folder exists, or a topic is not CDR with ros2msg; kIo with path and cause.
[[nodiscard]] Result<std::vector<std::string>> WriteRosbag2(
    McapReader& reader, const std::filesystem::path& folder,
    const std::function<void(std::uint64_t)>& progress);

}  // namespace conav::bag
