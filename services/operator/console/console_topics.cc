#include "operator/console/console_topics.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "common/msg/convert.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "operator/console/console_messages.h"

namespace conav::operators {
namespace {

constexpr std::uint32_t kTimeoutMs = 1000;

bool LiesIn(const Belief& belief, const Snapshot& snapshot) {
  const auto inside = [&](Cell cell) { return belief.wall_probability.Contains(cell); };
  return inside(snapshot.cell) && std::ranges::all_of(snapshot.path, inside) &&
         std::ranges::all_of(snapshot.visible.free, inside) &&
         std::ranges::all_of(snapshot.visible.walls, inside);
}

}  // namespace

PredictionClient::PredictionClient(bus::Participant& participant, const Clock& clock)
    : clock_(clock),
      client_(std::string(bus::kConsoleClient) + UniqueId()),
      requests_(participant, bus::kPerceptionRequest),
      replies_(participant, bus::kPredictionReply) {}

void PredictionClient::Ask(const Snapshot& snapshot, const Belief& belief) {
  if (!LiesIn(belief, snapshot)) return;
  Question question{.of = {snapshot.robot, snapshot.world, snapshot.sequence_number, "", {}},
                    .rows = belief.wall_probability.rows(),
                    .columns = belief.wall_probability.columns()};
  question.request.client = client_;
  question.request.request_id = ++last_id_;
  question.request.timeout_ms = kTimeoutMs;
  question.request.queries = {{belief.wall_probability, snapshot.path, snapshot.cell,
                               snapshot.heading_rad, snapshot.visible}};
  Send(open_[snapshot.robot] = std::move(question));
}

void PredictionClient::Send(Question& question) {
  ++question.tries;
  question.repeat_at = clock_.Now() + kRepeat;
  bus::Send(requests_, ToMessage(question.request));
}

std::vector<Prediction> PredictionClient::Step() {
  std::vector<Prediction> predictions;
  for (const auto& message : replies_.Take()) {
    if (message.client() != client_) continue;
    const auto asked = std::ranges::find_if(open_, [&](const auto& entry) {
      return entry.second.request.request_id == message.request_id();
    });
    if (asked == open_.end()) continue;
    const auto reply = ToDomain(message, asked->second.rows, asked->second.columns);
    if (!reply || reply->status != PerceptionStatus::kOk || reply->answers.size() != 1) continue;
    Prediction& prediction = predictions.emplace_back(std::move(asked->second.of));
    prediction.model = reply->model;
    prediction.answer = reply->answers.front();
    open_.erase(asked);
  }
  const auto is_due = [this](const Question& asked) { return clock_.Now() >= asked.repeat_at; };
  for (auto& [robot, asked] : open_) {
    if (is_due(asked) && asked.tries < kTries) Send(asked);
  }
  std::erase_if(open_, [&](const auto& entry) { return is_due(entry.second); });
  return predictions;
}

namespace {

constexpr std::uint32_t kMostEdits = 65536;  // cells of a request, as on the bus
/// s; answered requests are remembered for longer, so that no repeat is carried out twice.
constexpr double kLongestValid = 3600.0;
constexpr double kDriveAdvisedAgainst = 0.3;  // s, round trip
constexpr double kDriveRefused = 1.0;         // s, round trip

console::Session NamedSession(const OperatorConfig& config) {
  console::Session session =
      SessionOf(config.robots, config.method ? std::string(Name(*config.method)) : "");
  session.set_name(config.recording.session);
  for (const std::string& robot : config.goals.robots) session.add_goal_robots(robot);
  return session;
}

console::Mode ModeOf(const TaskOptions& task) {
  if (!task.on()) return console::MODE_SUPERVISE;
  return task.kind == "mapping" ? console::MODE_MAPPING_TASK : console::MODE_STUDY;
}

console::Welcome WelcomeOf(const OperatorConfig& config) {
  console::Welcome welcome;
  welcome.set_mode(ModeOf(config.task));
  welcome.set_experimenter(config.task.on() && config.task.experimenter);
  console::Limits* limits = welcome.mutable_limits();
  const RequestLimits cells =
      LimitsOf(static_cast<std::size_t>(config.console.max_message_kib) * 1024,
               {kMostEdits, static_cast<std::uint32_t>(config.max_path_cells)});
  limits->set_edit_cells(cells.edit_cells);
  limits->set_path_cells(cells.path_cells);
  limits->set_guidance_valid_for(config.max_guidance_s);
  limits->set_control_time(config.control.control_s);
  limits->set_drive_advised_against(kDriveAdvisedAgainst);
  limits->set_drive_refused(kDriveRefused);
  return welcome;
}

}  // namespace

struct ConsoleTopics::RobotLink {
  RobotLink(bus::Participant& participant, const std::string& name, const std::string& world)
      : name(name),
        world(world),
        map(participant, bus::kRobotMap, bus::kRobotMapChanges, name),
        plan(participant, bus::kPlan, name),
        goal_pose(participant, bus::kGoalPose, name) {}

  std::string name;
  std::string world;
  bus::ChangesSubscriber<nav_msgs::msg::OccupancyGrid> map;
  bus::Subscriber<nav_msgs::msg::Path> plan;
  std::optional<bus::Subscriber<conav_msgs::msg::SearchReport>> search;     // while pages show it
  std::optional<bus::Subscriber<sensor_msgs::msg::CompressedImage>> image;  // while pages attend
  bus::Subscriber<geometry_msgs::msg::PoseStamped> goal_pose;
  std::optional<GridGeometry> geometry;  // of its world
  Cell cell;
  double heading_rad = 0.0;
};

ConsoleTopics::ConsoleTopics(bus::Participant& participant, const OperatorConfig& config,
                             const ServiceMonitor& services, const Clock& clock)
    : participant_(participant),
      services_(services),
      clock_(clock),
      keeps_secrets_(config.task.on()),
      layouts_(keeps_secrets_ ? std::make_unique<LayoutTopics>(participant, config.task) : nullptr),
      snapshots_(config.console.image_bytes()),
      state_(updates_, NamedSession(config)),
      predictions_(participant, clock) {
  for (const auto& [robot, world] : config.world_of_robot()) {
    robots_.push_back(std::make_unique<RobotLink>(participant, robot, world));
  }
  gateway_ =
      std::make_unique<Gateway>(config.console, Gateway::Shared{updates_, frames_, snapshots_},
                                WelcomeOf(config), [&participant] { participant.Wake(); });
  LOG_INFO("console", "url", url());
  const std::string& url_file = config.console.url_file;
  if (url_file.empty()) return;
  if (const auto written = WriteFile(url_file, url() + "\n"); !written) {
    throw StartupError("operator.console.url_file: " + written.error().text);
  }
}

ConsoleTopics::~ConsoleTopics() = default;

void ConsoleTopics::Receive(const bus::Stamped<RobotState>& stamped) {
  const RobotState& state = stamped.value;
  state_.Receive(state, services_.PublishedAt(stamped.source, stamped.writer));
  for (const auto& robot : robots_) {
    if (robot->name != state.robot) continue;
    robot->cell = state.cell;
    robot->heading_rad = state.heading_rad;
  }
}

void ConsoleTopics::ReceiveGeometry(const std::string& world, const MapUpdate& map) {
  state_.ReceiveGeometry(world, map);
  for (const auto& robot : robots_) {
    if (robot->world != world) continue;
    robot->geometry = map.geometry();
  }
}

void ConsoleTopics::Receive(const Belief& belief, const BeliefGrid& initial) {
  beliefs_[belief.world] = belief;
  state_.Receive(belief, initial);
}

void ConsoleTopics::Receive(const Guidance& guidance) { state_.Receive(guidance); }
void ConsoleTopics::Receive(const AttentionQueueState& queue) { state_.Receive(queue); }

std::vector<ConsoleTopics::Asked> ConsoleTopics::Step() {
  for (const auto& robot : robots_) TakeFrom(*robot);
  TakePredictions();
  std::vector<Asked> asked;
  for (PageEvent& event : gateway_->Take()) Take(event, asked);
  FollowPages();
  return asked;
}

void ConsoleTopics::TakeFrom(RobotLink& robot) {
  if (!keeps_secrets_) TakeKnowledge(robot);
  TakeFrames(robot);
}

void ConsoleTopics::TakeKnowledge(RobotLink& robot) {
  for (const MapUpdate& map : robot.map.TakeValid(kToDomain)) {
    state_.ReceiveSeen(robot.name, robot.world, map);
  }
  if (robot.search) {
    for (const SearchReport& report : robot.search->TakeValid(kToDomain)) state_.Receive(report);
  }
  for (const Position& goal : robot.goal_pose.TakeValid(kToDomain)) {
    if (!robot.geometry) continue;
    if (const auto cell = CellAt(goal, *robot.geometry)) {
      state_.ReceiveGoalPose(robot.name, *cell, state_.TimeOf(robot.world).ToSeconds());
    }
  }
  for (const auto& path : robot.plan.Take()) {
    if (!robot.geometry) continue;
    state_.ReceivePlan(robot.name, ToDomain(path.header().stamp()).value_or(SimTime{}),
                       CellsAt(ToPositions(path), *robot.geometry));
  }
}

void ConsoleTopics::TakeFrames(RobotLink& robot) {
  if (!robot.image) return;
  for (auto& [image, source, writer] : robot.image->TakeStamped()) {
    console::Frame frame;
    frame.set_robot(robot.name);
    frame.set_stamp(ToDomain(image.header().stamp()).value_or(SimTime{}).ToSeconds());
    frame.set_received_at(services_.PublishedAt(source, writer));
    frame.mutable_cell()->set_row(robot.cell.row);
    frame.mutable_cell()->set_column(robot.cell.column);
    frame.set_heading(robot.heading_rad);
    frame.mutable_jpeg()->assign(image.data().begin(), image.data().end());
    frames_.Put(std::move(frame));
  }
}

void ConsoleTopics::FollowPages() {
  const bool may_watch = state_.session().streams() || !keeps_secrets_;
  for (const auto& robot : robots_) {
    const auto is_shown = [&](auto shown) {
      return std::ranges::any_of(
          attended_, [&](const auto& page) { return (page.second.*shown).contains(robot->name); });
    };
    const auto follow = [&](auto& subscriber, const auto& topic, bool wanted) {
      if (wanted == subscriber.has_value()) return;
      subscriber.reset();
      if (wanted) subscriber.emplace(participant_, topic, robot->name);
    };
    follow(robot->image, bus::kCameraImage, may_watch && is_shown(&PageAttends::robots));
    follow(robot->search, bus::kSearchReport,
           !keeps_secrets_ && (!participant_.over_link() || is_shown(&PageAttends::searches)));
  }
}

void ConsoleTopics::ReceiveServices() {
  const double now_s = WallSeconds();
  for (const auto& [name, service] : services_.services()) {
    const std::chrono::duration<double> age = clock_.Now() - service.received_at;
    const auto level =
        service.silent ? console::LEVEL_SILENT : static_cast<console::Level>(service.level);
    state_.Receive(ServiceHealth{name, level, services_.MessageOf(service)}, now_s - age.count());
  }
}

void ConsoleTopics::Serve(TaskTopics& task) {
  task.SetPresent(presence_.HasOperator());
  for (const auto& [page, request] : std::exchange(study_, {})) Reply(page, task.Answer(request));
  for (console::Update& update : task.TakeUpdates()) {
    if (update.has_task()) layouts_->AddTags(*update.mutable_task());
    state_.ReceiveStep(std::move(update));
  }
}

void ConsoleTopics::Receive(const Alert& alert) { state_.Receive(ToConsole(alert)); }
void ConsoleTopics::Receive(bus::Stamped<Snapshot>&& stamped) {
  Snapshot& snapshot = stamped.value;
  if (snapshot.streamed) return;
  console::Snapshot message =
      ToConsole(snapshot, services_.PublishedAt(stamped.source, stamped.writer));
  // First the pixels: a page fetches them as soon as it is sent the picture.
  snapshots_.Put(snapshot.robot, snapshot.sequence_number, std::move(snapshot.jpeg));
  if (keeps_secrets_) {
    message.mutable_free_cells()->Clear();
    message.mutable_wall_cells()->Clear();
  }
  state_.Receive(std::move(message));
  const auto belief = beliefs_.find(snapshot.world);
  if (belief != beliefs_.end() && !keeps_secrets_) predictions_.Ask(snapshot, belief->second);
}

void ConsoleTopics::TakePredictions() {
  for (const Prediction& p : predictions_.Step()) {
    state_.Receive(p.robot, p.world, p.snapshot, p.model, p.answer);
  }
}

void ConsoleTopics::Take(PageEvent& event, std::vector<Asked>& asked) {
  if (const auto* body = std::get_if<PageAsked>(&event.body)) {
    if (auto request = Read(event, *body)) asked.push_back(*std::move(request));
  } else if (std::holds_alternative<PageJoined>(event.body)) {
    presence_.Join(event.page, event.who);
    state_.Receive(presence_.People());
  } else if (std::holds_alternative<PageLeft>(event.body)) {
    attended_.erase(event.page);
    presence_.Leave(event.page, clock_.Now());
    state_.Receive(presence_.People());
  } else if (std::holds_alternative<PageUsed>(event.body)) {
    used_by_.insert(event.who.client);
  } else if (auto* attends = std::get_if<PageAttends>(&event.body)) {
    attended_[event.page] = std::move(*attends);
  } else if (auto* layout = std::get_if<console::PageLayout>(&event.body); layout && layouts_) {
    const bool is_participant =
        event.who.role == console::ROLE_OPERATOR || event.who.role == console::ROLE_ADMIN;
    if (is_participant) layouts_->Publish(event.who.client, *layout);
  }
}

std::optional<ConsoleTopics::Asked> ConsoleTopics::Read(const PageEvent& event,
                                                        const PageAsked& body) {
  const console::Request& request = body.request;
  const std::string& client = event.who.client;
  const double now_s = WallSeconds();
  if (auto study = ToStudyRequest(request, client)) {
    std::string refusal = CheckNow(event.who, body, now_s, kDriveRefused);
    if (refusal.empty()) {
      study_.push_back({event.page, *std::move(study)});
    } else {
      Reply(event.page, {client, request.id(), false, std::move(refusal), 0});
    }
    return std::nullopt;
  }
  auto domain = ToOperatorRequest(request, client, state_.TimeOf(request.world()));
  if (!domain) {
    Reply(event.page, {client, request.id(), false, domain.error().text, 0});
    return std::nullopt;
  }
  std::string refusal = CheckNow(event.who, body, now_s, kDriveRefused);
  if (refusal.empty() && request.valid_until() > now_s + kLongestValid) {
    refusal = fmt::format("valid_until is more than {} s ahead", kLongestValid);
  }
  return Asked{[this, page = event.page](const OperatorReply& reply) { Reply(page, reply); },
               *std::move(domain), request.valid_until(), std::move(refusal)};
}

void ConsoleTopics::Reply(std::uint64_t page, const OperatorReply& reply) {
  console::Reply message;
  message.set_id(reply.request_id);
  message.set_accepted(reply.accepted);
  message.set_reason(reply.reason);
  message.set_revision(reply.revision);
  gateway_->Send(page, message);
}

void ConsoleTopics::Receive(const ControlRegistry& control) {
  const double now_s = WallSeconds();
  for (const auto& [name, robot] : control.robots()) {
    console::Control message;
    message.set_robot(name);
    message.set_holder(robot.holder);
    message.set_reason(robot.reason);
    message.set_holder_name(presence_.NameOf(robot.holder));
    const std::chrono::duration<double> left = robot.held_until - clock_.Now();
    if (!robot.holder.empty()) message.set_held_until(now_s + left.count());
    message.set_stopped(robot.stop.stopped);
    message.set_stopped_by(robot.stop.given_by);
    message.set_stop_reason(robot.stop.reason);
    message.set_asked_by(robot.asked_by);
    message.set_asked_by_name(presence_.NameOf(robot.asked_by));
    message.set_ask_reason(robot.ask_reason);
    state_.Receive(std::move(message));
  }
}

void ConsoleTopics::Receive(const AnswerRequest& answer, const std::string& client) {
  state_.ReceiveAnswer(answer.robot, answer.snapshot, client);
}

void ConsoleTopics::Receive(const OperatorEvent& event) {
  // An experimenter's notes are about the participant, who does not see them.
  if (keeps_secrets_ && event.kind == RequestKind::kNote) return;
  state_.Receive(ToConsole(event, WallSeconds()));
}

void ConsoleTopics::SetReadiness(const Health& health) {
  nlohmann::ordered_json report;
  report["ready"] = health.level == Health::Level::kOk;
  report["message"] = health.message;
  for (const auto& [name, value] : health.values) report["values"][name] = value;
  gateway_->SetReadiness(
      {health.level == Health::Level::kOk,
       report.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"});
}

}  // namespace conav::operators
