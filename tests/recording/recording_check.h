#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

/// What others' readers and ours find in a recording. Each fails the test, with what was said, when a
/// reader fails.
namespace conav::testing {

/// By @mcap/core and @foxglove/rosmsg2-serialization, see recording/read_recording.mjs. The topics
/// named in `last` have their last message.
nlohmann::json ReadByOthers(const std::filesystem::path& recording,
                            const std::vector<std::string>& last = {});

/// By sql.js and @foxglove/rosmsg2-serialization: a rosbag2 folder that was made of `recording`.
nlohmann::json ReadBagByOthers(const std::filesystem::path& folder,
                               const std::filesystem::path& recording);

/// By conav-bag; `arguments` as typed into a shell.
nlohmann::json ReadByConav(const std::filesystem::path& recording,
                           const std::string& arguments = "");

/// Messages by topic, in what either of them found.
std::map<std::string, int> CountsOf(const nlohmann::json& found);

}  // namespace conav::testing
