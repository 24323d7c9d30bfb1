#include "operator/supervision/command_log.h"

#include <fmt/core.h>

#include <utility>
#include <variant>
#include <vector>

#include "common/msg/checks.h"
#include "common/runtime/text.h"

namespace conav::operators {
namespace {

std::string Names(const std::vector<std::string>& robots) {
  return robots.empty() ? "all robots" : Join(robots, ", ");
}

/// The one that is named; empty for several, or all.
std::string OnlyRobot(const std::vector<std::string>& robots) {
  return robots.size() == 1 ? robots.front() : "";
}

std::string Count(std::size_t count, const char* one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

std::string WithReason(std::string text, const std::string& reason) {
  return reason.empty() ? text : fmt::format("{}: {}", text, reason);
}

std::string GoalsText(std::size_t added, std::size_t removed) {
  if (removed == 0) return "set " + Count(added, "goal");
  if (added == 0) return "removed " + Count(removed, "goal");
  return fmt::format("set {}, removed {}", Count(added, "goal"), Count(removed, "goal"));
}

/// Fills robot, text and cells of an event.
struct Describe {
  OperatorEvent& event;

  void Say(const std::string& robot, std::string text, std::size_t cells = 0) const {
    event.robot = robot;
    event.text = std::move(text);
    event.cells = static_cast<std::uint32_t>(cells);
  }
  void operator()(const EditRequest& edit) const {
    Say("", fmt::format("edited {} of the map", Count(edit.edits.size(), "cell")),
        edit.edits.size());
  }
  void operator()(const GuideRequest& guide) const {
    Say(guide.robot, PathText(guide.path.size()), guide.path.size());
  }
  void operator()(const AnswerRequest& answer) const {
    Say(answer.robot, fmt::format("picture {}: nothing new", answer.snapshot));
  }
  void operator()(const StopRequest& stop) const {
    Say(OnlyRobot(stop.robots), WithReason("stopped " + Names(stop.robots), stop.reason));
  }
  void operator()(const ResumeRequest& resume) const {
    Say(OnlyRobot(resume.robots), "resumed " + Names(resume.robots));
  }
  void operator()(const TakeControlRequest& take) const {
    const char* what = take.ask ? "asked for control of " : "took control of ";
    Say(OnlyRobot(take.robots), WithReason(what + Names(take.robots), take.reason));
  }
  void operator()(const ReleaseControlRequest& release) const {
    Say(OnlyRobot(release.robots), "released " + Names(release.robots));
  }
  void operator()(const AcknowledgeRequest&) const { Say("", "acknowledged an alert"); }
  void operator()(const ShelveRequest&) const { Say("", "snoozed an alert"); }
  void operator()(const FinishRequest&) const { Say("", "finished the maze"); }
  void operator()(const GoalsRequest& goals) const {
    Say(goals.robot, GoalsText(goals.add.size(), goals.remove.size()));
  }
  void operator()(const NoteRequest& note) const { Say("", note.text); }
  void operator()(const DriveRequest& drive) const { Say(drive.robot, "drove"); }
  void operator()(const SelectRequest& select) const { Say(select.robot, "selected the robot"); }
};

}  // namespace

std::string PathText(std::size_t cells) {
  return cells == 0 ? "removed the path" : "drew a path of " + Count(cells, "cell");
}

OperatorEvent EventOf(const OperatorRequest& request, const OperatorReply& reply, SimTime stamp) {
  OperatorEvent event;
  event.stamp = stamp;
  event.kind = KindOf(request);
  event.accepted = reply.accepted;
  event.client = request.client;
  event.world = request.world;
  event.revision = reply.revision;
  std::visit(Describe{event}, request.body);
  if (!reply.accepted) event.text = fmt::format("refused ({}): {}", event.text, reply.reason);
  event.text = Readable(event.text.substr(0, convert::kMaxText));
  return event;
}

bool IsStored(const OperatorRequest& request) {
  return !std::holds_alternative<DriveRequest>(request.body) &&
         !std::holds_alternative<SelectRequest>(request.body);
}

const std::string* GuidedRobot(const OperatorRequest& request) {
  if (const auto* answer = std::get_if<AnswerRequest>(&request.body)) return &answer->robot;
  const auto* guide = std::get_if<GuideRequest>(&request.body);
  return guide == nullptr ? nullptr : &guide->robot;
}

bool NeedsMap(const OperatorRequest& request) {
  return std::holds_alternative<EditRequest>(request.body) || GuidedRobot(request) != nullptr;
}

}  // namespace conav::operators
