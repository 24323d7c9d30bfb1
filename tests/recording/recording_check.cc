#include "recording/recording_check.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdlib>

#include "common/runtime/file.h"
#include "support/temporary_folder.h"

namespace conav::testing {
namespace {

nlohmann::json Run(const std::string& command) {
  const test::TemporaryFolder folder;
  const std::string redirected = fmt::format("{} >'{}' 2>'{}'", command, (folder / "out").string(),
                                             (folder / "error").string());
  const int status = std::system(redirected.c_str());
  INFO(command << "\n" << ReadFile(folder / "error").value());
  REQUIRE(WIFEXITED(status));
  REQUIRE(WEXITSTATUS(status) == 0);
  return nlohmann::json::parse(ReadFile(folder / "out").value());
}

}  // namespace

nlohmann::json ReadByOthers(const std::filesystem::path& recording,
                            const std::vector<std::string>& last) {
  std::string command = fmt::format("'{}' '{}/read_recording.mjs' '{}'", CONAV_NODE,
                                    CONAV_READERS_DIR, recording.string());
  for (const std::string& topic : last) command += fmt::format(" --last '{}'", topic);
  return Run(command);
}

nlohmann::json ReadBagByOthers(const std::filesystem::path& folder,
                               const std::filesystem::path& recording) {
  return Run(fmt::format("'{}' '{}/read_rosbag2.mjs' '{}' '{}'", CONAV_NODE, CONAV_READERS_DIR,
                         folder.string(), recording.string()));
}

nlohmann::json ReadByConav(const std::filesystem::path& recording, const std::string& arguments) {
  return Run(
      fmt::format("'{}/conav-bag' '{}' --json - {}", CONAV_BIN_DIR, recording.string(), arguments));
}

std::map<std::string, int> CountsOf(const nlohmann::json& found) {
  std::map<std::string, int> counts;
  const nlohmann::json& topics = found["topics"];
  for (const auto& [name, topic] : topics.items()) {
    if (topics.is_array()) {
      counts[topic["topic"]] = topic["messages"];
    } else {
      counts[name] = topic["count"];
    }
  }
  return counts;
}

}  // namespace conav::testing
