#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/bus/participant.h"
#include "common/bus/subscriber.h"
#include "common/grid/grid.h"
#include "common/runtime/random.h"
#include "common/service/robot_state_topics.h"
#include "launcher/demo.h"
#include "launcher/demo_options.h"
#include "launcher/soak_checks.h"
#include "operator/simulated/operator_client.h"

// One user: main, which parses the options and prints the result.

namespace conav::launcher {

/// The options of `conav soak`.
struct SoakOptions {
  DemoOptions demo;
  double hours = 2.0;
  double kill_every_s = 45.0;  // on average; 0 = never
};

/// The demo that a soak drives: no page waits for people, goals come from clients.
DemoOptions DemoOf(const SoakOptions& options);

/// Kept open like a page that shows everything and reads all that comes; its content is not decoded.
class PageWatcher {
 public:
  PageWatcher() = default;
  ~PageWatcher() { Close(); }
  PageWatcher(const PageWatcher&) = delete;
  PageWatcher& operator=(const PageWatcher&) = delete;

  /// Connects to the console whose URL is in `url_file`, where it is not connected; sends what keeps a
  /// page alive and reads what came. Never blocks for longer than a connection on this machine.
  void Turn(const std::filesystem::path& url_file, const std::string& attended, double now_s);
  void Close();
  std::uint64_t bytes() const { return bytes_; }

 private:
  void Connect(const std::filesystem::path& url_file);
  void Send(const std::string& message);

  int socket_ = -1;
  double ping_at_s_ = 0.0;
  double connect_at_s_ = 0.0;
  std::uint64_t bytes_ = 0;
};

/// Drives, edits, stops, watches and kills the services of a demo, and checks Invariants on the way.
///
/// Kills come in the first third of the time; memory is measured in the second half, when what fills
/// up has done so. Everything random comes from the seed.
/// Threads: that of the demo.
class Soak {
 public:
  /// Joins the demo's domain. Throws StartupError: the bus.
  Soak(const SoakOptions& options, const Outcome& outcome, const Clock& clock);

  /// One turn; call it while the demo follows its services, which are `running`.
  void Turn(const std::vector<const Process*>& running);
  /// After the demo's end: compares the database, and says what else was wrong with the run.
  void Finish(const DemoResult& result);

  const Invariants& invariants() const { return invariants_; }
  /// The fastest growth of a service, MB/h; nothing where too little was measured.
  std::optional<double> WorstSlope() const;
  /// A line per process and the violations.
  std::string Table() const;
  nlohmann::ordered_json Json(const DemoResult& result) const;

 private:
  struct Robot {
    Robot(bus::Participant& participant, const RobotRecord& record);

    std::string name;
    std::string world;
    RobotStateTopics states;
    bus::Subscriber<conav_msgs::msg::RobotCommand> commands;
    std::optional<RobotState> state;
  };
  struct World {
    World(bus::Participant& participant, const std::string& name, OccupancyGrid truth);

    std::string name;
    OccupancyGrid truth;
    std::vector<Cell> places;  // where goals can be
    bus::Subscriber<conav_msgs::msg::BeliefMap> beliefs;
    std::optional<Belief> belief;
  };
  /// A client that edits maps, one edit at a time.
  struct Editor {
    Editor(bus::Participant& participant, const Clock& clock, const std::string& name);

    operators::OperatorClient client;
    double next_s = 0.0;
    std::optional<AcceptedEdit> asked;
  };
  enum class StopPhase { kNone, kAsked, kBraking, kHeld, kResuming };

  double Now() const;
  SimTime Stamp() const;
  void Receive();
  void TakeReplies();
  void GiveGoals();
  void Edit(Editor& editor);
  void TurnStop();
  void AskStop();
  void AskResume();
  void Watch();
  void Kill(const std::vector<const Process*>& running);
  void Sample(const std::vector<const Process*>& running);
  void CheckProgress();
  void SayMinute();
  double Between(double low, double high) { return low + (high - low) * random_.Unit(); }
  /// A row for each process of those sampled in the second half.
  struct Row {
    std::string process;
    ProcessSample first;
    ProcessSample last;
    std::optional<double> slope;  // MB/h
    int kills = 0;
  };
  std::vector<Row> Rows() const;

  SoakOptions options_;
  const Clock& clock_;
  Clock::TimePoint start_;
  std::filesystem::path folder_;
  Random random_;
  bus::Participant participant_;
  Invariants invariants_;
  std::deque<Robot> robots_;
  std::deque<World> worlds_;
  bus::Subscriber<conav_msgs::msg::PlannerLease> leases_;
  std::deque<Editor> editors_;
  operators::OperatorClient supervisor_;
  std::map<std::uint64_t, std::string> goals_asked_;  // robot, by request
  StopPhase phase_ = StopPhase::kNone;
  std::uint64_t stop_request_ = 0;
  std::set<std::string> stopped_;
  double stop_due_s_ = 10.0;  // of the next phase
  std::optional<bus::Subscriber<sensor_msgs::msg::CompressedImage>> camera_;
  std::string watched_;
  double watch_until_s_ = 0.0;
  PageWatcher page_;
  std::vector<std::string> victims_;  // of this round, the next last
  double kill_at_s_;
  std::map<std::string, int> kills_;
  std::vector<ProcessSample> samples_;
  double sample_at_s_ = 0.0;
  double say_at_s_ = 60.0;
  std::uint64_t moves_ = 0;
  double moved_at_s_ = 0.0;
  std::uint64_t refused_edits_ = 0;
  std::uint64_t goals_given_ = 0;
  std::uint64_t stops_ = 0;
  std::uint64_t frames_ = 0;
  double ended_s_ = 0.0;
};

}  // namespace conav::launcher
