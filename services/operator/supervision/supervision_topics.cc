#include "operator/supervision/supervision_topics.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "common/msg/convert.h"
#include "common/runtime/log.h"

namespace conav::operators {
namespace {

constexpr std::chrono::seconds kPeriod{1};
constexpr std::chrono::seconds kConfirmLimit{2};
/// Each load of a page is a client.
constexpr std::size_t kClientsRemembered = 64;

/// In the order of OperatorRequest::body.
constexpr std::array kKinds{
    "edit",         "guide",           "drive",       "select", "answer", "stop",  "resume",
    "take_control", "release_control", "acknowledge", "shelve", "finish", "goals", "note"};
static_assert(kKinds.size() == std::variant_size_v<decltype(OperatorRequest::body)>);

const char* NameOfKind(const OperatorRequest& request) { return kKinds[request.body.index()]; }

}  // namespace

AttentionTopics::AttentionTopics(bus::Participant& participant, const AttentionOptions& options,
                                 const Clock& clock)
    : options_(options),
      clock_(clock),
      queue_(options),
      meter_(options),
      publisher_(participant, bus::kAttentionQueue) {
  Publish({});
}

void AttentionTopics::Accepted(const std::string& client, const std::string& robot_or_world,
                               SimTime now) {
  meter_.Accepted(client, robot_or_world, now);
}

OperatorReply AttentionTopics::Select(const OperatorRequest& request, SimTime now) {
  const auto known = std::ranges::find(newest_selections_, request.client, &OperatorReply::client);
  if (known != newest_selections_.end()) {
    if (known->request_id == request.request_id) return *known;
    newest_selections_.erase(known);
  }
  if (newest_selections_.size() >= kClientsRemembered) newest_selections_.pop_front();
  OperatorReply& newest = newest_selections_.emplace_back();
  TakeArrivals(now);
  const auto selected = queue_.Select(request.client, std::get<SelectRequest>(request.body), now);
  newest = {request.client, request.request_id, selected.has_value(), "", 0};
  if (selected) {
    meter_.Selected(request.client, *selected, now);
  } else {
    newest.reason = selected.error().text;
  }
  return newest;
}

void AttentionTopics::TakeArrivals(SimTime now) {
  for (const AttentionItem& item : queue_.TakeArrivals()) meter_.Arrived(item, now);
}

void AttentionTopics::Step(SimTime now) {
  queue_.Update(meter_.times(), now);
  TakeArrivals(now);
  for (const auto& departure : queue_.TakeDepartures()) meter_.Left(departure);
  meter_.Advance(queue_.robots_at_work(), queue_.robots_waiting(), now);
  const bool changed = queue_.items() != published_.items;
  if (changed || clock_.Now() - published_at_ >= kPeriod) Publish(now);
}

void AttentionTopics::Publish(SimTime now) {
  published_ = {now, published_.revision + 1, options_.order, queue_.items(), meter_.Workload(now)};
  published_at_ = clock_.Now();
  bus::Send(publisher_, ToMessage(published_));
}

std::vector<OperatorRequest> RequestTopics::Take(const ServiceMonitor& processes) {
  std::vector<OperatorRequest> requests;
  for (auto& [request, source, writer] : requests_.TakeValidStamped(kToDomain)) {
    const std::string refusal = names_.Claim(request.client, writer, clock_.Now());
    if (refusal.empty()) {
      const auto delay_s = processes.DelayOf(source, writer);
      const bool seems_late = delays_.IsLate(request.client, ToWallSeconds(source), WallSeconds());
      if (delay_s ? *delay_s <= RequestDelays::kLongestUnderWay : !seems_late) {
        requests.push_back(std::move(request));
      } else {
        LOG_WARNING("request came too late", "client", request.client, "id", request.request_id);
      }
    } else if (const auto held_back = refusals_logged_.Allow()) {
      LOG_WARNING("request ignored", "client", request.client, "id", request.request_id, "reason",
                  refusal, "held_back", *held_back);
    }
  }
  return requests;
}

ControlTopics::ControlTopics(bus::Participant& participant, const OperatorConfig& config,
                             BeliefStore& store, const Clock& clock)
    : store_(store), clock_(clock), registry_(config.world_of_robot(), config.control) {
  for (const auto& [robot, stop] : store.stops()) registry_.Adopt(stop);
  for (const auto& [name, robot] : registry_.robots()) {
    stops_[name] = std::make_unique<StopPublisher>(participant, bus::kStopOrder, name);
    if (robot.stop.revision > 0) Publish(robot.stop);
    if (robot.stop.stopped) unconfirmed_[name] = {clock.Now(), false};
  }
}

bool ControlTopics::Handles(const OperatorRequest& request) {
  return std::holds_alternative<StopRequest>(request.body) ||
         std::holds_alternative<ResumeRequest>(request.body) ||
         std::holds_alternative<TakeControlRequest>(request.body) ||
         std::holds_alternative<ReleaseControlRequest>(request.body);
}

Result<std::vector<StopOrder>> ControlTopics::Decide(const OperatorRequest& request, SimTime now,
                                                     ControlRegistry& registry) const {
  if (const auto* stop = std::get_if<StopRequest>(&request.body)) {
    return registry.Stop(request.client, *stop, now);
  }
  if (const auto* resume = std::get_if<ResumeRequest>(&request.body)) {
    return registry.Resume(request.client, *resume, now);
  }
  const auto none = [] { return std::vector<StopOrder>{}; };
  if (const auto* take = std::get_if<TakeControlRequest>(&request.body)) {
    return registry.Take(request.client, *take, clock_.Now()).map(none);
  }
  const auto& release = std::get<ReleaseControlRequest>(request.body);
  return registry.Release(request.client, release, clock_.Now()).map(none);
}

BeliefStore::Answer ControlTopics::Answer(const OperatorRequest& request, SimTime now) {
  ControlRegistry decided = registry_;  // counts only when it is stored, or stops
  const auto orders = Decide(request, now, decided);
  if (!orders) return {Refusal(request, orders.error().text)};
  BeliefStore::Answer answer = store_.Keep(request, *orders);
  if (!answer.changed) {
    if (!std::holds_alternative<StopRequest>(request.body)) return answer;
    // A stop does not wait for the disk; Step() stores it.
    answer.reply = {request.client, request.request_id, true, "", 0};
    answer.changed = true;
  }
  registry_ = std::move(decided);
  for (const StopOrder& order : *orders) {
    registry_.Adopt(order);
    Publish(order);
    if (!order.stopped) {
      unconfirmed_.erase(order.robot);
    } else if (!registry_.robots().at(order.robot).confirmed_stopped) {
      unconfirmed_.try_emplace(order.robot, Unconfirmed{clock_.Now(), true});
    }
  }
  return answer;
}

void ControlTopics::Step() {
  registry_.Expire(clock_.Now());
  if (clock_.Now() < save_due_at_) return;
  save_due_at_ = clock_.Now() + kSavePeriod;
  for (const auto& [name, robot] : registry_.robots()) {
    const auto stored = store_.stops().find(name);
    const bool is_stored = stored != store_.stops().end() && stored->second == robot.stop;
    if (!is_stored && !robot.stop.given_by.empty() && !store_.SaveStop(robot.stop)) return;
  }
}

std::string ControlTopics::CheckAllowed(const OperatorRequest& request) const {
  const Clock::TimePoint now = clock_.Now();
  if (std::holds_alternative<EditRequest>(request.body)) {
    return registry_.CheckEdit(request.client, request.world, now);
  }
  if (const auto* guide = std::get_if<GuideRequest>(&request.body)) {
    return registry_.CheckCommand(request.client, guide->robot, now);
  }
  if (const auto* answer = std::get_if<AnswerRequest>(&request.body)) {
    return registry_.CheckCommand(request.client, answer->robot, now);
  }
  if (const auto* goals = std::get_if<GoalsRequest>(&request.body)) {
    return registry_.CheckCommand(request.client, goals->robot, now);
  }
  const auto* drive = std::get_if<DriveRequest>(&request.body);
  if (drive == nullptr || drive->drive == DriveAction::kStop) return "";
  const auto found = registry_.robots().find(drive->robot);
  if (found != registry_.robots().end() && found->second.stop.stopped) {
    return drive->robot + " is stopped: resume it first";
  }
  return registry_.CheckCommand(request.client, drive->robot, now);
}

void ControlTopics::Receive(const RobotState& state) {
  const auto again = registry_.Receive(state);
  if (const auto found = unconfirmed_.find(state.robot); found != unconfirmed_.end()) {
    if (state.stopped) {
      unconfirmed_.erase(found);
    } else if (!found->second.has_reported) {
      found->second = {clock_.Now(), true};
    }
  }
  if (!again) return;
  LOG_WARNING("another program resumed a stopped robot, stopped again", "robot", state.robot,
              "its_revision", state.stop_revision);
  resumed_elsewhere_.insert(state.robot);
  registry_.Adopt(*again);
  Publish(*again);
  unconfirmed_.try_emplace(state.robot, Unconfirmed{clock_.Now(), true});
}

bool ControlTopics::TakeResumedElsewhere(const std::string& name) {
  if (!resumed_elsewhere_.contains(name)) return false;
  const ControlRegistry::Robot& robot = registry_.robots().at(name);
  if (robot.confirmed_stopped || !robot.stop.stopped) resumed_elsewhere_.erase(name);
  return true;
}

bool ControlTopics::IsStopUnconfirmed(const std::string& robot) const {
  const auto found = unconfirmed_.find(robot);
  return found != unconfirmed_.end() && found->second.has_reported &&
         clock_.Now() - found->second.since >= kConfirmLimit;
}

void ControlTopics::Publish(const StopOrder& order) {
  bus::Send(*stops_.at(order.robot), ToMessage(order));
}

namespace {

constexpr std::size_t kProbesKept = 8;

/// On the scale of Clock, which nobody sets.
double MonotonicSeconds(Clock::TimePoint time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// So far off it is at least; negative = it may be right.
double Certain(const ClockOffset::Sample& clock) {
  return std::abs(clock.offset_s) - clock.round_trip_s / 2.0;
}

bool AreOfOneProcess(const bus::Guid& one, const bus::Guid& other) {
  return std::equal(one.begin(), one.begin() + bus::kParticipantBytes, other.begin());
}

}  // namespace

void ServiceMonitor::Take(const ReportedHealth& health, const bus::Guid& writer,
                          Clock::TimePoint now) {
  if (services_.size() >= kMostProcesses && !services_.contains(health.process)) {
    crowded_at_ = now;
    return;
  }
  ServiceStatus& service = services_[health.process];
  if (!service.started.empty() && health.started != service.started) service.restarted_at = now;
  if (!AreOfOneProcess(service.writer, writer)) service.clock = {};
  service.name = health.process;
  service.level = health.level;
  service.message = health.message;
  service.received_at = now;
  service.started = health.started;
  service.writer = writer;
  const bool is_own = health.process == own_name_;  // by the clock that all are measured with
  if (is_own || !health.clock || std::ranges::find(asked_, health.clock->asked) == asked_.end()) {
    return;
  }
  service.host = health.clock->host;
  service.clock.Add(std::chrono::duration<double>(health.clock->asked).count(),
                    health.clock->received_s, health.clock->sent_s, MonotonicSeconds(now));
}

void ServiceMonitor::Step() {
  const Clock::TimePoint now = clock_.Now();
  for (const auto& [array, source, writer] : diagnostics_.TakeStamped()) {
    for (const ReportedHealth& health : HealthOf(array)) Take(health, writer, now);
  }
  if (now >= probe_due_at_) {
    probe_due_at_ = now + kProbePeriod;
    if (asked_.size() >= kProbesKept) asked_.pop_front();
    asked_.push_back(now.time_since_epoch());
    rosgraph_msgs::msg::Clock probe;
    probe.clock(RosWallTime(asked_.back()));
    bus::Send(probes_, probe);
  }
  if (crowded_at_) {
    const bool is_crowded = now - *crowded_at_ <= kSilentAfter;
    services_["diagnostics"] = {
        "diagnostics", is_crowded ? Health::Level::kError : Health::Level::kOk,
        fmt::format("more than {} processes report: later ones are left out", kMostProcesses), now};
  }
  for (auto& [name, service] : services_) service.silent = now - service.received_at > kSilentAfter;
}

std::optional<double> ServiceMonitor::DelayOf(bus::SourceTime source,
                                              const bus::Guid& writer) const {
  for (const auto& [name, service] : services_) {
    if (!AreOfOneProcess(service.writer, writer) || !service.clock.best()) continue;
    const double published_s = ToWallSeconds(source) - service.clock.best()->offset_s;
    return std::max(0.0, MonotonicSeconds(clock_.Now()) - published_s);
  }
  return std::nullopt;
}

double ServiceMonitor::PublishedAt(bus::SourceTime source, const bus::Guid& writer) const {
  const double now_s = WallSeconds();
  if (const auto delay_s = DelayOf(source, writer)) return now_s - *delay_s;
  return std::min(ToWallSeconds(source), now_s);
}

std::map<std::string, ClockOffset::Sample> ServiceMonitor::ClocksOfHosts() const {
  const double ours_s = WallSeconds() - MonotonicSeconds(clock_.Now());
  std::map<std::string, ClockOffset::Sample> hosts;
  for (const auto& [name, service] : services_) {
    auto measured = service.clock.best();
    if (!measured || service.silent) continue;
    measured->offset_s -= ours_s;
    auto& shown = hosts.try_emplace(service.host, *measured).first->second;
    if (Certain(*measured) > Certain(shown)) shown = *measured;
  }
  return hosts;
}

std::string ServiceMonitor::MessageOf(const ServiceStatus& service) const {
  std::string message = service.silent ? "silent" : service.message;
  const auto hosts = ClocksOfHosts();
  const auto clock = hosts.find(service.host);
  if (clock == hosts.end() || Certain(clock->second) <= kClockLimitS) return message;
  return fmt::format("{}; its host's clock is {:.2f} s {}", message,
                     std::abs(clock->second.offset_s),
                     clock->second.offset_s > 0.0 ? "ahead" : "behind");
}

void ServiceMonitor::AddTo(Health& health) const {
  for (const auto& [host, clock] : ClocksOfHosts()) {
    health.values.emplace_back("clock_ahead_ms/" + host,
                               fmt::format("{:.0f}", clock.offset_s * 1000.0));
  }
}

std::vector<ProcessCondition> ServiceMonitor::Conditions() const {
  std::vector<ProcessCondition> processes;
  for (const auto& [name, service] : services_) {
    processes.push_back({.name = name,
                         .failed = service.level == Health::Level::kError,
                         .silent = service.silent,
                         .message = service.message,
                         .restarted = service.restarted_at &&
                                      clock_.Now() - *service.restarted_at < kRestartShown});
  }
  return processes;
}

AlertTopics::AlertTopics(BeliefStore& store, bus::Participant& participant)
    : store_(store), participant_(participant) {
  registry_.Restore(store.alerts());
  if (!store.beliefs().empty()) {
    kept_ = fmt::format("it kept its maps; requests answered before: {}",
                        store.CountRequests().value_or(0));
  }
  for (const auto& [id, alert] : registry_.alerts()) changes_.push_back(alert);
}

bool AlertTopics::Handles(const OperatorRequest& request) {
  return std::holds_alternative<AcknowledgeRequest>(request.body) ||
         std::holds_alternative<ShelveRequest>(request.body);
}

BeliefStore::Answer AlertTopics::Answer(const OperatorRequest& request, double now_s) {
  const auto* acknowledge = std::get_if<AcknowledgeRequest>(&request.body);
  const auto* shelve = std::get_if<ShelveRequest>(&request.body);
  const auto alert = acknowledge != nullptr
                         ? registry_.Acknowledge(acknowledge->alert, request.client, now_s)
                         : registry_.Shelve(shelve->alert, shelve->duration_s, now_s);
  if (!alert) return {Refusal(request, alert.error().text)};
  BeliefStore::Answer answer = store_.Keep(request, {}, {*alert});
  if (!answer.changed) return answer;
  registry_.Adopt(*alert);
  changes_.push_back(*alert);
  return answer;
}

void AlertTopics::Update(const std::vector<RobotCondition>& robots, const ServiceMonitor& services,
                         const std::optional<std::string>& storage_failure, double now_s) {
  std::vector<ProcessCondition> processes = services.Conditions();
  if (!started_s_) started_s_ = now_s;
  if (!kept_.empty()) {
    const std::string& name = participant_.node_name();
    auto own = std::ranges::find(processes, name, &ProcessCondition::name);
    if (own == processes.end()) own = processes.insert(own, {.name = name});
    own->restarted = now_s - *started_s_ < static_cast<double>(kRestartShown.count());
    own->kept = kept_;
  }
  for (SystemCondition& system : other_systems_) system.just_met = false;
  for (const bus::Event& event : participant_.TakeEvents()) {
    if (event.kind != bus::Event::Kind::kOtherSystem) continue;
    other_systems_.push_back({event.detail, true});
  }
  std::vector<ClockCondition> clocks;
  for (const auto& [host, clock] : services.ClocksOfHosts()) {
    clocks.push_back({host, clock.offset_s, clock.round_trip_s / 2.0});
  }
  const auto [changed, dropped] = registry_.Update(
      FindingsOf(robots, processes, storage_failure, other_systems_, clocks), now_s);
  if (changed.empty() && dropped.empty()) return;
  // That the disk fails is an alert, too: shown although it cannot be stored.
  if (const auto saved = store_.SaveAlerts(changed, dropped); !saved) {
    LOG_WARNING("alerts not stored", "reason", saved.error().text);
  }
  changes_.insert(changes_.end(), changed.begin(), changed.end());
}

std::vector<Alert> AlertTopics::TakeChanges() { return std::exchange(changes_, {}); }

bool RequestLog::RememberRefusal(const OperatorRequest& request) {
  std::pair refusal(request.client, request.request_id);
  if (std::find(refusals_.begin(), refusals_.end(), refusal) != refusals_.end()) return false;
  refusals_.push_back(std::move(refusal));
  if (refusals_.size() > kRefusalsRemembered) refusals_.pop_front();
  return true;
}

bool RequestLog::Note(const OperatorRequest& request, const BeliefStore::Answer& answer,
                      SimTime now) {
  const bool drives = std::holds_alternative<DriveRequest>(request.body);
  const OperatorReply& reply = answer.reply;
  if (reply.accepted) {
    ++accepted_;
    if (drives) return false;
    LOG_INFO("accepted", "kind", NameOfKind(request), "client", request.client, "id",
             request.request_id, "world", request.world, "revision", reply.revision, "sim_s",
             now.ToSeconds());
    return answer.changed;
  }
  if (!RememberRefusal(request)) return false;
  ++refused_;
  if (const auto held_back = refusals_logged_.Allow()) {
    LOG_WARNING("refused", "kind", NameOfKind(request), "client", request.client, "id",
                request.request_id, "world", request.world, "reason", reply.reason, "held_back",
                *held_back);
  }
  return !drives;
}

}  // namespace conav::operators
