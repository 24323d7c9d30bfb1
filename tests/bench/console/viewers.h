#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "bench/console/load.h"
#include "launcher/process.h"
#include "support/child_process.h"

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

/// The least that can follow the console's protocol: one WebSocket that takes every message, decodes
/// it and looks at the clock. What a page shows later than it has it, the browser takes.
///
/// Threads: one of its own.
class BareClient {
 public:
  /// Of the service on `port` of this machine. `frames`: robot whose live view it takes, as a page does.
  BareClient(int port, const Drive& drive, const std::string& frames);
  ~BareClient();
  BareClient(const BareClient&) = delete;
  BareClient& operator=(const BareClient&) = delete;

  /// In ms, of every state that came since the call before, from its sending until it was decoded.
  std::vector<double> TakeAges();
  double cpu_s() const { return cpu_s_; }
  bool ended() const { return ended_; }

 private:
  void Run(int port, const std::string& frames);

  const Drive drive_;
  std::atomic<double> cpu_s_ = 0.0;
  std::atomic<bool> stop_ = false;
  std::atomic<bool> ended_ = false;
  std::mutex mutex_;  // guards ages_ms_
  std::vector<double> ages_ms_;
  std::thread thread_;
};

/// What one page showed in a while; all ages in ms.
struct PageAges {
  std::vector<double> shown;  // of each state when it came on screen
  std::vector<double> drawn;  // of the same when the map drew it
  std::vector<double> any;    // of what was on screen, every 10 ms
  double frames_per_s = 0.0;  // drawings of the map
  double states_per_s = 0.0;  // that came on screen, of one robot
};

/// Headless browsers with the console, by tests/browser/bench_pages.mjs. Every function blocks until
/// it is done, and throws std::runtime_error with what Node says when it cannot be.
class Browsers {
 public:
  /// `folder`: for their profiles.
  explicit Browsers(const std::filesystem::path& folder);
  ~Browsers() { process_.Wait(); }

  /// There are `pages` of them afterwards, which show the robots.
  void Open(const std::string& url, int pages, const Drive& drive);

  struct Measured {
    std::vector<PageAges> pages;  // without the one that stands still
    double cpu_s = 0.0;           // of all browsers' processes
  };
  void Begin() { Ask({{"do", "begin"}}); }
  Measured End();

  /// To all processes of the last one.
  void Stop() { Ask({{"do", "signal"}, {"name", "SIGSTOP"}}); }
  void Continue() { Ask({{"do", "signal"}, {"name", "SIGCONT"}}); }

 private:
  nlohmann::json Ask(const nlohmann::json& command);

  test::ChildProcess process_;
};

}  // namespace conav::bench
