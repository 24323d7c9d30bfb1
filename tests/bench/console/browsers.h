#pragma once

#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/console/world.h"

namespace conav::bench {

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
  ~Browsers();
  Browsers(const Browsers&) = delete;
  Browsers& operator=(const Browsers&) = delete;

  /// There are `pages` of them afterwards, which show the robots.
  void Open(const std::string& url, int pages, const Drive& drive);

  struct Measured {
    std::vector<PageAges> pages;  // without the one that stands still
    double cpu_s = 0.0;           // of all browsers' processes
  };
  void Begin();
  Measured End();

  /// To all processes of the last one.
  void Stop();
  void Continue();

 private:
  nlohmann::json Ask(const nlohmann::json& command);
  void Signal(const char* name);

  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  pid_t pid_ = -1;
  std::unique_ptr<std::FILE, CloseFile> commands_;
  std::unique_ptr<std::FILE, CloseFile> answers_;
};

}  // namespace conav::bench
