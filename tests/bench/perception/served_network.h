#pragma once

#include <filesystem>
#include <string>

#include "common/bus/participant.h"
#include "launcher/domain_lease.h"
#include "launcher/process.h"
#include "planner/perception/remote_model.h"

namespace conav::bench {

/// conav-nhpm as a process of its own on one DDS vendor, and a planner's side that asks it, on the
/// loopback interface in a domain of their own.
class ServedNetwork {
 public:
  /// Config and log go into `folder`. Throws StartupError.
  ServedNetwork(const std::string& vendor, const std::filesystem::path& weights,
                const std::filesystem::path& folder);

  const std::string& vendor() const { return vendor_; }
  PerceptionModel& model() { return model_; }

 private:
  std::string vendor_;
  launcher::DomainLease domain_;
  launcher::Process process_;
  bus::Participant participant_;
  planner::RemotePerceptionModel model_;
};

}  // namespace conav::bench
