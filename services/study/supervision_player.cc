#include "study/supervision_player.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "common/bus/subscriber.h"
#include "common/msg/convert.h"
#include "launcher/bus_place.h"
#include "launcher/process.h"
#include "launcher/run_folder.h"

namespace conav::study {
namespace {

/// Calls visit(key, field) for each stored field: one list for both directions.
template <class Record, class Visit>
void VisitFields(Record& record, Visit&& visit) {
  visit("robots", record.trial.robots);
  visit("order", record.trial.order);
  visit("seed", record.trial.seed);
  visit("failure", record.failure);
  visit("attempts", record.attempts);
  visit("minutes", record.minutes);
  visit("goals", record.goals);
  visit("wall_s", record.wall_s);
  visit("pace", record.pace);
}

template <class Workload, class Visit>
void VisitWorkload(Workload& workload, Visit&& visit) {
  visit("robots", workload.robots);
  visit("interactions", workload.interactions);
  visit("abandoned", workload.abandoned);
  visit("observed_s", workload.observed_s);
  visit("busy_s", workload.busy_s);
  visit("interaction_time_s", workload.interaction_time_s);
  visit("neglect_time_s", workload.neglect_time_s);
  visit("waiting_time_s", workload.waiting_time_s);
  visit("waiting_time_p95_s", workload.waiting_time_p95_s);
  visit("value_lost", workload.value_lost);
  visit("utilisation", workload.utilisation);
  visit("attended_robots", workload.attended_robots);
  visit("fan_out", workload.fan_out);
  visit("fan_out_with_waits", workload.fan_out_with_waits);
  visit("predicted_utilisation", workload.predicted_utilisation);
  visit("predicted_waiting_time_s", workload.predicted_waiting_time_s);
}

auto PutInto(nlohmann::ordered_json& json) {
  return [&json](const char* key, const auto& field) { json[key] = field; };
}

auto TakeFrom(const nlohmann::json& json) {
  return [&json](const char* key, auto& field) { json.at(key).get_to(field); };
}

using namespace std::chrono_literals;

constexpr auto kGrace = 5s;
constexpr auto kReadyLimit = 60s;
constexpr double kStartS = 60.0;    // limit on the wall time in which simulators start
constexpr double kSlowness = 10.0;  // how much slower than requested the worlds may run

launcher::DemoOptions PlaceOptions(const SupervisionOptions& options) {
  launcher::DemoOptions demo;
  demo.dds = options.dds;
  return demo;
}

class Trial {
 public:
  Trial(const SupervisionTrial& trial, const SupervisionOptions& options,
        const std::filesystem::path& program_folder, const Clock& clock)
      : trial_(trial),
        options_(options),
        program_folder_(program_folder),
        clock_(clock),
        episode_(EpisodeFor(trial, options)),
        run_(options.out / "runs" / trial.name(), std::chrono::system_clock::now(), trial.seed),
        place_(launcher::JoinFreeDomain(PlaceOptions(options), episode_)),
        queue_(*place_.participant, bus::kAttentionQueue),
        health_(*place_.participant, bus::kDiagnostics) {}

  SupervisionRecord Play(const StopToken& stop) {
    record_.trial = trial_;
    const auto bus = launcher::BusOptions(PlaceOptions(options_), place_.lease.domain(),
                                          place_.participant->vendor());
    const auto services = PlanServices(trial_, options_, bus, episode_, run_);
    for (const SupervisionProcess& process : services) Start(process);
    if (WaitUntilReady(services.size(), stop)) {
      for (const auto& process : PlanSimulators(trial_, options_, bus, episode_)) Start(process);
      Follow(stop);
    }
    place_.observer.reset();
    processes_.StopAll(kGrace);
    Measure();
    return record_;
  }

 private:
  void Start(const SupervisionProcess& process) {
    run_.Write(run_.config(process.name), process.config);
    processes_.Start(process.name,
                     {(program_folder_ / process.program).string(), "--config",
                      run_.config(process.name).string()},
                     run_.log(process.name));
  }

  bool SomethingDied() {
    for (const launcher::Process* process : processes_.TakeEnded()) {
      const auto last = launcher::LastLines(process->log(), 1);
      record_.failure = fmt::format("{} died: {}{}", process->name(), process->end()->Describe(),
                                    last.empty() ? "" : "; its log ends: " + last.front());
      return true;
    }
    return false;
  }

  /// Waits until each service has reported its health once.
  bool WaitUntilReady(std::size_t services, const StopToken& stop) {
    const auto deadline = clock_.Now() + kReadyLimit;
    std::set<std::string> reported;
    while (reported.size() < services) {
      if (SomethingDied()) return false;
      if (stop.stop_requested() || clock_.Now() > deadline) {
        record_.failure = stop.stop_requested() ? "interrupted"
                                                : fmt::format("{} of {} services ready after 60 s",
                                                              reported.size(), services);
        return false;
      }
      place_.participant->Wait(20ms);
      for (const auto& message : health_.Take()) {
        for (const auto& status : message.status()) reported.insert(status.name());
      }
    }
    return true;
  }

  double ElapsedSeconds(Clock::TimePoint since) const {
    return std::chrono::duration<double>(clock_.Now() - since).count();
  }

  void Follow(const StopToken& stop) {
    const auto start = clock_.Now();
    const double limit_s = kStartS + kSlowness * 60.0 * options_.minutes / options_.speed;
    while (!IsOver() && record_.failure.empty()) {
      place_.participant->Wait(20ms);
      place_.observer->Take();
      for (const auto& message : queue_.Take()) {
        if (auto queue = ToDomain(message)) newest_ = *std::move(queue);
      }
      record_.wall_s = ElapsedSeconds(start);
      if (SomethingDied()) return;
      if (stop.stop_requested()) record_.failure = "interrupted";
      if (record_.wall_s > limit_s) {
        record_.failure = fmt::format("not finished after {:.0f} s", limit_s);
      }
    }
  }

  bool IsOver() const {
    const SimTime end = SimTime::FromSeconds(60.0 * options_.minutes);
    return std::ranges::all_of(episode_.robots, [end](const launcher::RobotRecord& robot) {
      return robot.state && robot.state->stamp >= end;
    });
  }

  void Measure() {
    if (!newest_ && record_.failure.empty()) record_.failure = "no attention queue received";
    if (newest_) record_.workload = newest_->workload;
    double seconds = 0.0;
    for (const launcher::RobotRecord& robot : episode_.robots) {
      if (!robot.state) continue;
      record_.goals += static_cast<double>(robot.state->goals_reached.size());
      seconds += robot.state->stamp.ToSeconds();
    }
    seconds /= static_cast<double>(episode_.robots.size());
    record_.minutes = seconds / 60.0;
    if (record_.wall_s > 0.0) record_.pace = seconds / record_.wall_s / options_.speed;
  }

  SupervisionTrial trial_;
  const SupervisionOptions& options_;
  const std::filesystem::path& program_folder_;
  const Clock& clock_;
  launcher::Episode episode_;
  launcher::RunFolder run_;
  launcher::BusPlace place_;
  bus::Subscriber<conav_msgs::msg::AttentionQueue> queue_;
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> health_;
  launcher::ProcessGroup processes_;
  std::optional<AttentionQueueState> newest_;
  SupervisionRecord record_;
};

}  // namespace

nlohmann::ordered_json ToJson(const SupervisionRecord& record) {
  nlohmann::ordered_json json{{"name", record.trial.name()}, {"operator", "simulated"}};
  VisitFields(record, PutInto(json));
  VisitWorkload(record.workload, PutInto(json["workload"]));
  return json;
}

Result<void> FromJson(const std::string& text, SupervisionRecord& record) {
  try {
    const auto json = nlohmann::json::parse(text);
    VisitFields(record, TakeFrom(json));
    VisitWorkload(record.workload, TakeFrom(json.at("workload")));
    return {};
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, error.what());
  }
}

SupervisionRecord PlayTrial(const SupervisionTrial& trial, const SupervisionOptions& options,
                            const std::filesystem::path& program_folder, const Clock& clock,
                            const StopToken& stop) {
  try {
    return Trial(trial, options, program_folder, clock).Play(stop);
  } catch (const std::exception& error) {
    SupervisionRecord record;
    record.trial = trial;
    record.failure = error.what();
    return record;
  }
}

}  // namespace conav::study
