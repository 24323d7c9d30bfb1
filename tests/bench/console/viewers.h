#pragma once

#include <fmt/core.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>
#include <utility>

#include "bench/console/load.h"
#include "bench/support/bench_program.h"
#include "common/runtime/file.h"
#include "integration/operator/page_client.h"
#include "launcher/process.h"
#include "operator/config.h"
#include "support/child_process.h"
#include "support/loopback.h"
#include "support/wait.h"

/// The service under load and those who look at it.
namespace conav::bench {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using operators::PageClient;

inline launcher::Process Start(const fs::path& folder, const Drive& drive, int domain) {
  operators::OperatorConfig config;
  config.bus = test::OnLoopback("", domain);
  config.robots.clear();
  for (int i = 0; i < drive.robots; ++i) config.robots.push_back("w1/" + RobotName(i));
  config.database = (folder / "operator.db").string();
  config.console.port = 0;
  config.console.url_file = (folder / "url").string();
  const fs::path file = folder / "operator.yaml";
  if (const auto written = WriteFile(file, DumpConfig("operator", config)); !written) {
    throw StartupError(written.error().text);
  }
  const fs::path program = fs::read_symlink("/proc/self/exe").parent_path() / "conav-operator";
  return {"conav-operator", {program.string(), "--config", file.string()}, folder / "operator.log"};
}

inline constexpr std::chrono::milliseconds kLookAround{50};
inline constexpr double kPingPeriodS = 0.5;  // as a page does

/// What a process has used: s of processor time since its start, MB of memory of its own now.
struct Usage {
  double cpu_s = 0.0;
  double memory_mb = 0.0;
};

/// The operator service with its page, on any free port; ended with this object.
class ConsoleService {
 public:
  /// `folder`: for its configuration, database and log. Blocks until it listens. Throws StartupError.
  ConsoleService(const fs::path& folder, const Drive& drive, int domain)
      : process_(Start(folder, drive, domain)), url_(WaitForUrl(folder / "url")) {
    port_ = std::stoi(url_.substr(url_.rfind(':') + 1));
  }

  const std::string& url() const { return url_; }
  int port() const { return port_; }
  /// Throws StartupError with the end of its log when it has died.
  Usage Used() {
    if (process_.Poll()) throw StartupError(WithLog("conav-operator has died:"));
    Usage usage;
    std::string text;
    std::getline(std::ifstream(fmt::format("/proc/{}/stat", process_.pid())), text);
    std::istringstream words(text.substr(text.rfind(") ") + 2));
    std::string skipped;
    for (int i = 0; i < 11; ++i) words >> skipped;  // utime and stime are the 14th and 15th of all
    double user = 0.0;
    double system = 0.0;
    words >> user >> system;
    usage.cpu_s = (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
    std::ifstream status(fmt::format("/proc/{}/status", process_.pid()));
    for (std::string word; status >> word;) {
      if (word == "RssAnon:") status >> usage.memory_mb;  // kB
    }
    usage.memory_mb /= 1024.0;
    return usage;
  }
  /// One of its own figures, of /metrics.
  double Metric(const std::string& name) const {
    if (const auto value = operators::MetricOf(port_, name)) return *value;
    throw StartupError("the service has no figure " + name);
  }

 private:
  std::string WaitForUrl(const fs::path& file) {
    std::string text;
    test::WaitUntil(
        [&] {
          text = ReadFile(file).value_or("");
          return text.ends_with('\n') || process_.Poll();
        },
        20s);
    if (text.ends_with('\n')) return text.substr(0, text.size() - 1);
    throw StartupError(WithLog("conav-operator does not serve its page:"));
  }
  /// `what`, and the end of its log.
  std::string WithLog(std::string what) const {
    for (const std::string& line : launcher::LastLines(process_.log(), 5)) what += "\n" + line;
    return what;
  }

  launcher::Process process_;
  std::string url_;
  int port_ = 0;
};

/// The least that can follow the console's protocol: one WebSocket that takes every message, decodes
/// it and looks at the clock. The rest of a page's age is the browser's.
///
/// Threads: one of its own.
class BareClient {
 public:
  /// Of the service on `port` of this machine. `frames`: robot whose live view it takes, as a page does.
  BareClient(int port, const Drive& drive, const std::string& frames)
      : drive_(drive), thread_([this, port, frames] { Run(port, frames); }) {}

  ~BareClient() {
    stop_ = true;
    thread_.join();
  }
  BareClient(const BareClient&) = delete;
  BareClient& operator=(const BareClient&) = delete;

  /// In ms, of every state that came since the call before, from its sending until it was decoded.
  std::vector<double> TakeAges() {
    const std::lock_guard lock(mutex_);
    return std::exchange(ages_ms_, {});
  }
  double cpu_s() const { return cpu_s_; }
  bool ended() const { return ended_; }

 private:
  void Run(int port, const std::string& frames) {
    operators::PageOptions options;
    options.port = port;
    PageClient client(options);
    console::ClientMessage hello;
    hello.mutable_hello()->set_name("Bare client");
    hello.mutable_hello()->set_instance("bench-console-bare-client");
    client.Send(hello);
    console::ClientMessage attend;
    attend.mutable_attend()->add_robots(frames);
    client.Send(attend);
    double pinged_s = 0.0;
    while (!stop_ && !client.ended()) {
      const auto message = client.Receive(kLookAround);
      const double now_s = WallSeconds();
      if (message) {
        const std::lock_guard lock(mutex_);
        for (const console::Update& update : message->updates().update()) {
          if (update.has_robot())
            ages_ms_.push_back(1000.0 * drive_.AgeS(update.robot().x(), now_s));
        }
      }
      if (now_s - pinged_s >= kPingPeriodS) {
        pinged_s = now_s;
        console::ClientMessage ping;
        ping.mutable_ping()->set_page_time(now_s);
        client.Send(ping);
      }
      cpu_s_ = ThreadSeconds();
    }
    ended_ = client.ended();
  }

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

/// A page's map while it is panned and zoomed.
struct MapMoves {
  std::vector<double> pan_ms;  // between two frames
  std::vector<double> zoom_ms;
  double cpu_ms = 0.0;  // of processor time of the browser for a frame
};

/// Headless browsers with the console, by tests/browser/bench_pages.mjs. Every function blocks until
/// it is done, and throws std::runtime_error with what Node says when it cannot be.
class Browsers {
 public:
  /// `folder`: for their profiles.
  explicit Browsers(const std::filesystem::path& folder)
      : process_(
            fmt::format("exec '{}' '{}' '{}'", CONAV_NODE, CONAV_BENCH_PAGES, folder.string())) {
    signal(SIGPIPE, SIG_IGN);  // a missing answer shows that it has ended
  }
  ~Browsers() { process_.Wait(); }

  /// There are `pages` of them afterwards, which show the robots.
  void Open(const std::string& url, int pages, const Drive& drive) {
    Ask({{"do", "open"},
         {"url", url},
         {"pages", pages},
         {"drive",
          {{"begin", drive.begin_s},
           {"west", drive.WestM()},
           {"speed", Drive::kSpeedMps},
           {"period", drive.PeriodS()},
           {"cellSize", Drive::kCellSizeM},
           {"rows", drive.side},
           {"columns", drive.side}}}});
  }

  struct Measured {
    std::vector<PageAges> pages;  // without the one that stands still
    double cpu_s = 0.0;           // of all browsers' processes
  };
  void Begin() { Ask({{"do", "begin"}}); }
  Measured End() {
    const nlohmann::json answer = Ask({{"do", "end"}});
    Measured measured;
    measured.cpu_s = answer["cpu"];
    for (const auto& page : answer["pages"]) {
      const double seconds = page["seconds"];
      PageAges ages{page["shown"], page["drawn"], page["any"],
                    page["frames"].get<double>() / seconds, 0.0};
      const int robots = page["robots"];
      if (robots > 0) ages.states_per_s = static_cast<double>(ages.shown.size()) / robots / seconds;
      measured.pages.push_back(std::move(ages));
    }
    return measured;
  }

  /// Of the first one, in `seconds`.
  MapMoves Move(double seconds) {
    const nlohmann::json answer = Ask({{"do", "move"}, {"seconds", seconds}});
    MapMoves moves{answer["pan"], answer["zoom"], 0.0};
    const auto frames = static_cast<double>(moves.pan_ms.size() + moves.zoom_ms.size());
    if (frames > 0.0) moves.cpu_ms = 1000.0 * answer["cpu"].get<double>() / frames;
    return moves;
  }

  /// To all processes of the last one.
  void Stop() { Ask({{"do", "signal"}, {"name", "SIGSTOP"}}); }
  void Continue() { Ask({{"do", "signal"}, {"name", "SIGCONT"}}); }

 private:
  nlohmann::json Ask(const nlohmann::json& command) {
    process_.Send(command.dump());
    if (!process_.ReadUntil("\n")) {
      throw std::runtime_error("the browsers' program has ended: " CONAV_BENCH_PAGES);
    }
    auto answer = nlohmann::json::parse(process_.TakeText());
    if (answer.contains("error")) {
      throw std::runtime_error("browsers: " + answer["error"].get<std::string>());
    }
    return answer;
  }

  test::ChildProcess process_;
};

}  // namespace conav::bench
