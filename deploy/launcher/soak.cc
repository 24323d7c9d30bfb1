#include "launcher/soak.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "launcher/bus_session.h"
#include "sim/world/world_spec.h"

namespace conav::launcher {
namespace {

// Shares of the time: kills come before the first, memory is measured after the second.
constexpr double kKillsEnd = 1.0 / 3.0;
constexpr double kMeasureBegins = 1.0 / 2.0;
/// A slope over less says nothing.
constexpr double kShortestMeasureS = 600.0;
constexpr double kSamplePeriodS = 5.0;
constexpr double kClientDeadlineS = 20.0;
/// A robot that is asked to stop may wait for an operator service or a simulator that was killed.
constexpr double kStopLimitS = 30.0;
constexpr double kNoMoveLimitS = 120.0;
constexpr std::size_t kGoalsAtOnce = 2;
constexpr const char* kSelf = "soak itself";

/// A WebSocket frame of a client: binary, masked with zeros.
std::string FrameOf(const std::string& message) {
  std::string frame{'\x82', static_cast<char>(0x80 | message.size()), '\0', '\0', '\0', '\0'};
  DEMAND(message.size() < 126, message.size());
  return frame + message;
}

/// A protobuf field of bytes.
std::string Field(int number, const std::string& content) {
  DEMAND(content.size() < 128, content.size());
  return std::string{static_cast<char>(number << 3 | 2), static_cast<char>(content.size())} +
         content;
}

std::string Request(int port) {
  return fmt::format(
      "GET /ws HTTP/1.1\r\nHost: 127.0.0.1:{0}\r\nOrigin: http://127.0.0.1:{0}\r\nUpgrade: "
      "websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
      "Sec-WebSocket-Version: 13\r\n\r\n",
      port);
}

}  // namespace

void PageWatcher::Send(const std::string& message) {
  const std::string frame = FrameOf(message);
  if (send(socket_, frame.data(), frame.size(), MSG_NOSIGNAL) < 0) Close();
}

void PageWatcher::Close() {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
}

void PageWatcher::Connect(const std::filesystem::path& url_file) {
  const std::string url = ReadFile(url_file).value_or("");
  if (!url.ends_with('\n')) return;  // the service writes it when it listens
  const int port = std::atoi(url.c_str() + url.rfind(':') + 1);
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const std::string request = Request(port);
  if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      send(socket_, request.data(), request.size(), MSG_NOSIGNAL) < 0) {
    return Close();
  }
  Send(Field(1, Field(2, "soak") + Field(3, "0123456789abcdef")));  // Hello: name, instance
}

void PageWatcher::Turn(const std::filesystem::path& url_file, const std::string& attended,
                       double now_s) {
  if (socket_ < 0 && now_s >= connect_at_s_) {
    connect_at_s_ = now_s + 1.0;
    Connect(url_file);
  }
  if (socket_ < 0) return;
  if (now_s >= ping_at_s_) {
    ping_at_s_ = now_s + 1.0;
    Send(Field(2, ""));                  // Ping
    Send(Field(5, Field(1, attended)));  // Attend
  }
  char buffer[65536];
  while (socket_ >= 0) {
    const ssize_t got = recv(socket_, buffer, sizeof buffer, MSG_DONTWAIT);
    if (got > 0) {
      bytes_ += static_cast<std::uint64_t>(got);
      continue;
    }
    if (got == 0 || (errno != EAGAIN && errno != EINTR)) Close();
    return;
  }
}

DemoOptions DemoOf(const SoakOptions& options) {
  DemoOptions demo = options.demo;
  demo.headless = true;
  demo.console = 0;
  demo.endless = true;
  demo.time_limit_s = options.hours * 3600.0;
  return demo;
}

Soak::Robot::Robot(bus::Participant& participant, const RobotRecord& record)
    : name(record.name),
      world(record.world),
      states(participant, record.name),
      commands(participant, bus::kRobotCommand, record.name) {}

Soak::World::World(bus::Participant& participant, const std::string& world, OccupancyGrid map)
    : name(world), truth(std::move(map)), beliefs(participant, bus::kBelief, world) {}

Soak::Editor::Editor(bus::Participant& participant, const Clock& clock, const std::string& name)
    : client(participant, clock, {name + UniqueId(), 0.5, kClientDeadlineS}) {}

Soak::Soak(const SoakOptions& options, const Outcome& outcome, const Clock& clock)
    : options_(options),
      clock_(clock),
      start_(clock.Now()),
      folder_(outcome.run_folder),
      random_(options.demo.seed),
      participant_("conav_soak", BusOptions(options.demo, outcome.domain,
                                            VendorOfService(options.demo.dds)->at("launcher"))),
      leases_(participant_, bus::kPlannerLease),
      supervisor_(participant_, clock, {"soak-supervisor-" + UniqueId(), 0.5, kClientDeadlineS}),
      kill_at_s_(options.kill_every_s) {
  const Episode episode = EpisodeOf(options.demo);
  for (const RobotRecord& robot : episode.robots) robots_.emplace_back(participant_, robot);
  for (std::size_t i = 0; i < episode.worlds.size(); ++i) {
    const auto spec = sim::MakeWorldSpec(WorldOptionsOf(options.demo, static_cast<int>(i)));
    if (!spec) throw StartupError(spec.error().text);  // CheckWorlds() has built it
    World& world = worlds_.emplace_back(participant_, episode.worlds[i].name, spec->truth);
    for (const Cell cell : ReachableCells(spec->truth, spec->starts.front())) {
      world.places.push_back(cell);
    }
  }
  // The simulated operator goes on beside clients of its name.
  for (const char* name : {"synthetic-operator-soak-a-", "synthetic-operator-soak-b-"}) {
    editors_.emplace_back(participant_, clock, name);
  }
}

double Soak::Now() const { return std::chrono::duration<double>(clock_.Now() - start_).count(); }

SimTime Soak::Stamp() const {
  return robots_.front().state ? robots_.front().state->stamp : SimTime{};
}

void Soak::Turn(const std::vector<const Process*>& running) {
  Receive();
  TakeReplies();
  GiveGoals();
  for (Editor& editor : editors_) Edit(editor);
  TurnStop();
  Watch();
  Kill(running);
  Sample(running);
  CheckProgress();
  SayMinute();
}

void Soak::Receive() {
  for (const PlannerLease& lease : leases_.TakeValid(kToDomain)) {
    invariants_.See(lease, clock_.Now());
  }
  for (Robot& robot : robots_) {
    for (const auto& command : robot.commands.TakeValidStamped(kToDomain)) {
      invariants_.See(command.value,
                      {command.writer.begin(), command.writer.begin() + bus::kParticipantBytes});
    }
    for (auto& state : robot.states.TakeStamped()) {
      invariants_.See(state.value);
      robot.state = std::move(state.value);
    }
  }
  for (World& world : worlds_) {
    for (Belief& belief : world.beliefs.TakeValid(kToDomain)) {
      invariants_.See(belief);
      world.belief = std::move(belief);
    }
  }
  if (camera_) frames_ += camera_->Take().size();
}

void Soak::TakeReplies() {
  for (const auto& outcome : supervisor_.Poll()) {
    const bool accepted = outcome.reply && outcome.reply->accepted;
    if (goals_asked_.erase(outcome.request_id) > 0) {
      goals_given_ += accepted ? 1 : 0;
    } else if (outcome.request_id != stop_request_) {
      continue;
    } else if (phase_ == StopPhase::kAsked) {
      // Without a reply it may have been carried out: the robots are resumed in any case.
      phase_ = accepted ? StopPhase::kBraking : StopPhase::kHeld;
      stop_due_s_ = accepted ? Now() + kStopLimitS : Now();
    } else if (phase_ == StopPhase::kResuming) {
      phase_ = accepted ? StopPhase::kNone : StopPhase::kHeld;
      stop_due_s_ = accepted ? Now() + Between(5.0, 20.0) : Now();
    }
  }
}

void Soak::GiveGoals() {
  for (Robot& robot : robots_) {
    const bool asked = std::ranges::any_of(
        goals_asked_, [&](const auto& request) { return request.second == robot.name; });
    if (asked || !robot.state || robot.state->goals_left.size() >= kGoalsAtOnce) continue;
    const World& world = *std::ranges::find(worlds_, robot.world, &World::name);
    const Cell cell = world.places[static_cast<std::size_t>(
        random_.Uniform(0, static_cast<std::int64_t>(world.places.size()) - 1))];
    if (cell == robot.state->cell) continue;
    GoalsRequest request{robot.name, {robot.state->grid.CellToPosition(cell)}, {}};
    goals_asked_[supervisor_.Send(robot.world, std::move(request), robot.state->stamp)] =
        robot.name;
  }
}

void Soak::Edit(Editor& editor) {
  for (auto& outcome : editor.client.Poll()) {
    if (outcome.reply && outcome.reply->accepted) {
      editor.asked->revision = outcome.reply->revision;
      invariants_.See(*std::move(editor.asked));
    } else if (outcome.reply) {
      ++refused_edits_;  // another client's came first
    }
    editor.asked.reset();
    editor.next_s = Now() + Between(0.2, 3.0);
  }
  const World& world = worlds_[static_cast<std::size_t>(
      random_.Uniform(0, static_cast<std::int64_t>(worlds_.size()) - 1))];
  if (editor.asked || Now() < editor.next_s || !world.belief) return;
  const BeliefGrid& map = world.belief->wall_probability;
  const Cell cell{static_cast<int>(random_.Uniform(1, map.rows() - 2)),
                  static_cast<int>(random_.Uniform(1, map.columns() - 2))};
  // Mostly right, so that robots get on.
  const bool wall = (world.truth[cell] == Occupancy::kOccupied) != random_.Chance(0.2);
  AcceptedEdit asked{.client = editor.client.name(),
                     .world = world.name,
                     .edit = {world.belief->revision, {{cell, wall}}},
                     .known_revision = invariants_.revision(world.name)};
  asked.request_id = editor.client.Send(world.name, asked.edit, Stamp());
  editor.asked = std::move(asked);
}

void Soak::TurnStop() {
  const auto stands = [&](const std::string& name) {
    const Robot& robot = *std::ranges::find(robots_, name, &Robot::name);
    return robot.state && Invariants::Stands(*robot.state);
  };
  if (phase_ == StopPhase::kBraking && std::ranges::all_of(stopped_, stands)) {
    for (const std::string& robot : stopped_) invariants_.Hold(robot);
    phase_ = StopPhase::kHeld;
    stop_due_s_ = Now() + Between(2.0, 6.0);
    ++stops_;
  }
  if (Now() < stop_due_s_) return;
  if (phase_ == StopPhase::kBraking) {
    for (const std::string& robot : stopped_) {
      if (!stands(robot)) {
        invariants_.Violated(fmt::format("{} did not stop within {} s", robot, kStopLimitS));
      }
    }
    AskResume();
  } else if (phase_ == StopPhase::kHeld) {
    AskResume();
  } else if (phase_ == StopPhase::kNone) {
    AskStop();
  }
}

void Soak::AskStop() {
  stopped_.clear();
  const bool all = random_.Chance(0.2);
  const std::int64_t chosen = random_.Uniform(0, static_cast<std::int64_t>(robots_.size()) - 1);
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    // A request concerns the robots of one world.
    const bool same_world = robots_[i].world == robots_[static_cast<std::size_t>(chosen)].world;
    if (i == static_cast<std::size_t>(chosen) || (all && same_world)) {
      stopped_.insert(robots_[i].name);
    }
  }
  const std::string& world = robots_[static_cast<std::size_t>(chosen)].world;
  stop_request_ =
      supervisor_.Send(world, StopRequest{{stopped_.begin(), stopped_.end()}, "soak"}, Stamp());
  phase_ = StopPhase::kAsked;
}

void Soak::AskResume() {
  for (const std::string& robot : stopped_) invariants_.Release(robot);
  const Robot& first = *std::ranges::find(robots_, *stopped_.begin(), &Robot::name);
  stop_request_ =
      supervisor_.Send(first.world, ResumeRequest{{stopped_.begin(), stopped_.end()}}, Stamp());
  phase_ = StopPhase::kResuming;
}

void Soak::Watch() {
  if (Now() >= watch_until_s_) {
    watch_until_s_ = Now() + Between(10.0, 60.0);
    watched_ = robots_[static_cast<std::size_t>(
                           random_.Uniform(0, static_cast<std::int64_t>(robots_.size()) - 1))]
                   .name;
    camera_.emplace(participant_, bus::kCameraImage, watched_);
    page_.Close();
  }
  page_.Turn(folder_ / "state" / "console.url", watched_, Now());
}

void Soak::Kill(const std::vector<const Process*>& running) {
  const double planned_s = options_.hours * 3600.0;
  if (options_.kill_every_s == 0.0 || Now() < kill_at_s_ || Now() > kKillsEnd * planned_s) return;
  kill_at_s_ = Now() + Between(0.5, 1.5) * options_.kill_every_s;
  if (victims_.empty()) {
    for (const Process* process : running) victims_.push_back(process->name());
    random_.Shuffle(victims_);
  }
  const auto victim = std::ranges::find_if(
      running, [&](const Process* process) { return process->name() == victims_.back(); });
  victims_.pop_back();
  if (victim == running.end()) return;
  ++kills_[(*victim)->name()];
  ::kill(-(*victim)->pid(), SIGKILL);  // with the program behind a wrapper
}

void Soak::Sample(const std::vector<const Process*>& running) {
  if (Now() < sample_at_s_) return;
  sample_at_s_ = Now() + kSamplePeriodS;
  const auto add = [&](const std::string& name, pid_t pid) {
    if (auto sample = SampleProcess(name, pid, Now())) samples_.push_back(*std::move(sample));
  };
  for (const Process* process : running) add(process->name(), process->pid());
  add(kSelf, getpid());
}

void Soak::CheckProgress() {
  std::uint64_t moves = 0;
  for (const Robot& robot : robots_) moves += robot.state ? robot.state->cell_moves : 0;
  if (moves > moves_) moved_at_s_ = Now();
  moves_ = moves;
  if (Now() - moved_at_s_ < kNoMoveLimitS) return;
  invariants_.Violated(fmt::format("no robot moved for {} s", kNoMoveLimitS));
  moved_at_s_ = Now();
}

void Soak::SayMinute() {
  if (Now() < say_at_s_) return;
  say_at_s_ += 60.0;
  std::map<std::string, double> rss_mb;
  for (const ProcessSample& sample : samples_) rss_mb[sample.process] = sample.rss_mb;
  std::string line = fmt::format(
      "{:.0f} min: {} moves, {} goals given, {} edits, {} stops, {} violations; MB:", Now() / 60.0,
      moves_, goals_given_, invariants_.edits().size(), stops_, invariants_.count());
  for (const auto& [process, mb] : rss_mb) line += fmt::format(" {} {:.0f}", process, mb);
  for (const auto& [process, count] : kills_) line += fmt::format(", killed {} {}", process, count);
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void Soak::Finish(const DemoResult& result) {
  ended_s_ = result.outcome.wall_s;
  if (result.outcome.reason == EndReason::kProcessDied ||
      result.outcome.reason == EndReason::kAllGoalsReached) {
    invariants_.Violated(OutcomeLine(result.outcome));
  }
  CheckJournal(folder_ / "state" / "operator.db", invariants_);
}

std::vector<Soak::Row> Soak::Rows() const {
  std::map<std::string, std::vector<ProcessSample>> of_process;
  for (const ProcessSample& sample : samples_) {
    if (sample.at_s >= kMeasureBegins * ended_s_) of_process[sample.process].push_back(sample);
  }
  std::vector<Row> rows;
  for (const auto& [process, samples] : of_process) {
    const auto killed = kills_.find(process);
    const bool is_long = ended_s_ * (1.0 - kMeasureBegins) >= kShortestMeasureS;
    rows.push_back({process, samples.front(), samples.back(),
                    is_long ? RssSlope(samples) : std::nullopt,
                    killed == kills_.end() ? 0 : killed->second});
  }
  return rows;
}

std::optional<double> Soak::WorstSlope() const {
  std::optional<double> worst;
  for (const Row& row : Rows()) {
    if (row.process == kSelf || !row.slope) continue;
    worst = std::max(worst.value_or(*row.slope), *row.slope);
  }
  return worst;
}

std::string Soak::Table() const {
  std::string text = fmt::format("{:<20}{:>6}{:>20}{:>10}{:>12}{:>12}\n", "process", "kills",
                                 "MB, second half", "MB/h", "fds", "threads");
  for (const Row& row : Rows()) {
    text += fmt::format("{:<20}{:>6}{:>20}{:>10}{:>12}{:>12}\n", row.process, row.kills,
                        fmt::format("{:.1f} -> {:.1f}", row.first.rss_mb, row.last.rss_mb),
                        row.slope ? fmt::format("{:.1f}", *row.slope) : "-",
                        fmt::format("{} -> {}", row.first.fds, row.last.fds),
                        fmt::format("{} -> {}", row.first.threads, row.last.threads));
  }
  text += fmt::format(
      "{:.0f} min: {} moves, {} goals given, {} edits accepted and {} refused, {} stops, {} camera "
      "pictures and {} for the page watched, {} violations\n",
      ended_s_ / 60.0, moves_, goals_given_, invariants_.edits().size(), refused_edits_, stops_,
      frames_, ShortBytes(page_.bytes()), invariants_.count());
  for (const std::string& violation : invariants_.violations()) {
    text += fmt::format("VIOLATED: {}\n", violation);
  }
  return text;
}

nlohmann::ordered_json Soak::Json(const DemoResult& result) const {
  nlohmann::ordered_json json{{"seed", options_.demo.seed},
                              {"robots", robots_.size()},
                              {"hours", options_.hours},
                              {"kill_every_s", options_.kill_every_s},
                              {"dds", result.outcome.dds},
                              {"wall_s", ended_s_},
                              {"ended", OutcomeLine(result.outcome)},
                              {"run", result.outcome.run_folder}};
  const auto worst = WorstSlope();
  json["metrics"] = {{"rss_slope_mb_per_h", worst ? nlohmann::ordered_json(*worst) : nullptr},
                     {"violations", invariants_.count()},
                     {"moves", moves_},
                     {"goals", goals_given_},
                     {"edits", invariants_.edits().size()},
                     {"refused_edits", refused_edits_},
                     {"stops", stops_},
                     {"frames", frames_},
                     {"page_bytes", page_.bytes()}};
  for (const Row& row : Rows()) {
    json["processes"].push_back(
        {{"process", row.process},
         {"kills", row.kills},
         {"rss_mb", {row.first.rss_mb, row.last.rss_mb}},
         {"rss_slope_mb_per_h", row.slope ? nlohmann::ordered_json(*row.slope) : nullptr},
         {"fds", {row.first.fds, row.last.fds}},
         {"threads", {row.first.threads, row.last.threads}}});
  }
  json["violations"] = invariants_.violations();
  return json;
}

}  // namespace conav::launcher
