#pragma once

#include <filesystem>
#include <string>

#include "common/bus/participant.h"
#include "launcher/process.h"
#include "planner/perception/remote_perception_model.h"

namespace conav::bench {

/// A folder below the temporary one, removed at the end.
class TemporaryFolder {
 public:
  /// Throws StartupError.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// conav-nhpm as a process of its own on one DDS vendor, and a planner's side that asks it, on the
/// loopback interface in a domain of their own.
class ServedNetwork {
 public:
  /// Config and log go into `folder`. Throws StartupError.
  ServedNetwork(const std::string& vendor, int domain, const std::filesystem::path& weights,
                const std::filesystem::path& folder);

  const std::string& vendor() const { return vendor_; }
  planner::PerceptionModel& model() { return model_; }

 private:
  std::string vendor_;
  launcher::Process process_;
  bus::Participant participant_;
  planner::RemotePerceptionModel model_;
};

}  // namespace conav::bench
