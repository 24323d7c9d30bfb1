#pragma once

#include <filesystem>
#include <string>

#include "bench/console/world.h"
#include "launcher/process.h"

namespace conav::bench {

/// What a process has used: s of processor time since its start, MB of memory of its own now.
struct Usage {
  double cpu_s = 0.0;
  double memory_mb = 0.0;
};

/// The operator service with its page, on any free port; ended with this object.
class ConsoleService {
 public:
  /// `folder`: for its configuration, database and log. Blocks until it listens. Throws StartupError.
  ConsoleService(const std::filesystem::path& folder, const Drive& drive, int domain);

  const std::string& url() const { return url_; }
  int port() const { return port_; }
  /// Throws StartupError with the end of its log when it has died.
  Usage Used();
  /// One of its own figures, of /metrics.
  double Metric(const std::string& name) const;

 private:
  std::string WaitForUrl(const std::filesystem::path& file);
  /// `what`, and the end of its log.
  std::string WithLog(std::string what) const;

  launcher::Process process_;
  std::string url_;
  int port_ = 0;
};

}  // namespace conav::bench
