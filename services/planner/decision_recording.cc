#include "planner/decision_recording.h"

#include "common/runtime/log.h"

namespace conav::planner {
namespace {

DecisionLog OpenLog(const std::filesystem::path& file) {
  auto log = DecisionLog::Open(file);
  if (!log) throw StartupError("planner.decision_file: " + log.error().text);
  return *std::move(log);
}

DecisionRecord RecordOf(const Decision& decision, const Situation& situation) {
  DecisionRecord record;
  record.report = decision.report;
  record.map = situation.map.cells;
  record.belief = situation.belief.wall_probability;
  record.goals_left = situation.state.goals_left;
  record.path = situation.state.path;
  if (situation.guidance) record.guidance = situation.guidance->path;
  record.plan = decision.plan;
  record.taken.kind = decision.action->kind;
  record.taken.target = decision.action->target;
  record.taken.heading_rad = decision.action->heading_rad;
  return record;
}

}  // namespace

DecisionRecording::DecisionRecording(const std::filesystem::path& file) : log_(OpenLog(file)) {}

void DecisionRecording::Record(const Decision& decision, const Situation& situation) {
  const DecisionRecord record = RecordOf(decision, situation);
  const std::lock_guard lock(mutex_);
  if (const auto written = log_.Append(record); !written) {
    ++lost_;
    if (const auto held_back = failures_logged_.Allow()) {
      LOG_ERROR("decision not recorded", "reason", written.error().text, "held_back", *held_back);
    }
    return;
  }
  ++recorded_;
}

}  // namespace conav::planner
