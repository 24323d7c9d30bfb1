#include "operator/console/command_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>
#include <variant>

namespace conav::operators {
namespace {

/// A Cell with two numbers of two bytes (maps have up to 2048 rows and columns), its tag and
/// length; a CellEdit with one of these and `wall`, its tag and length.
constexpr std::size_t kPathCellBytes = 8;
constexpr std::size_t kEditCellBytes = 12;
/// The rest of a request: names, numbers, the messages around.
constexpr std::size_t kOtherBytes = 512;

std::uint32_t Fitting(std::size_t message_bytes, std::size_t cell_bytes, std::uint32_t most) {
  const std::size_t room = std::max(message_bytes, kOtherBytes) - kOtherBytes;
  return static_cast<std::uint32_t>(std::min<std::size_t>(room / cell_bytes, most));
}

std::string Names(const std::vector<std::string>& robots) {
  return robots.empty() ? "all robots" : fmt::format("{}", fmt::join(robots, ", "));
}

/// The one that is named; empty for several, or all.
std::string OnlyRobot(const std::vector<std::string>& robots) {
  return robots.size() == 1 ? robots.front() : "";
}

std::string Cells(std::size_t count) {
  return fmt::format("{} {}", count, count == 1 ? "cell" : "cells");
}

std::string WithReason(std::string text, const std::string& reason) {
  return reason.empty() ? text : fmt::format("{}: {}", text, reason);
}

}  // namespace

RequestLimits LimitsOf(std::size_t message_bytes, RequestLimits most) {
  return {Fitting(message_bytes, kEditCellBytes, most.edit_cells),
          Fitting(message_bytes, kPathCellBytes, most.path_cells)};
}

std::string EditText(std::size_t cells) { return "edited " + Cells(cells) + " of the map"; }

std::string PathText(std::size_t cells) {
  return cells == 0 ? "removed the path" : "drew a path of " + Cells(cells);
}

std::string AnswerText(std::uint64_t snapshot) {
  return fmt::format("picture {}: nothing new", snapshot);
}

std::string StopText(const std::vector<std::string>& robots, const std::string& reason) {
  return WithReason("stopped " + Names(robots), reason);
}

std::string GoalsText(std::size_t added, std::size_t removed) {
  const auto goals = [](std::size_t count) {
    return fmt::format("{} {}", count, count == 1 ? "goal" : "goals");
  };
  if (removed == 0) return "set " + goals(added);
  if (added == 0) return "removed " + goals(removed);
  return fmt::format("set {}, removed {}", goals(added), goals(removed));
}

std::string ResumeText(const std::vector<std::string>& robots) {
  return "resumed " + Names(robots);
}

namespace {

/// Fills kind, robot and text of an event.
struct Describe {
  console::Event& event;

  void Say(console::EventKind kind, const std::string& robot, std::string text) const {
    event.set_kind(kind);
    event.set_robot(robot);
    event.set_text(std::move(text));
  }
  void operator()(const EditRequest& edit) const {
    Say(console::EVENT_EDIT, "", EditText(edit.edits.size()));
  }
  void operator()(const GuideRequest& guide) const {
    Say(console::EVENT_GUIDE, guide.robot, PathText(guide.path.size()));
  }
  void operator()(const AnswerRequest& answer) const {
    Say(console::EVENT_ANSWER, answer.robot, AnswerText(answer.snapshot));
  }
  void operator()(const StopRequest& stop) const {
    Say(console::EVENT_STOP, OnlyRobot(stop.robots), StopText(stop.robots, stop.reason));
  }
  void operator()(const ResumeRequest& resume) const {
    Say(console::EVENT_RESUME, OnlyRobot(resume.robots), ResumeText(resume.robots));
  }
  void operator()(const TakeControlRequest& take) const {
    Say(console::EVENT_TAKE_CONTROL, OnlyRobot(take.robots),
        WithReason("took control of " + Names(take.robots), take.reason));
  }
  void operator()(const ReleaseControlRequest& release) const {
    Say(console::EVENT_RELEASE_CONTROL, OnlyRobot(release.robots),
        "released " + Names(release.robots));
  }
  void operator()(const AcknowledgeRequest&) const {
    Say(console::EVENT_NONE, "", "acknowledged an alert");
  }
  void operator()(const ShelveRequest&) const { Say(console::EVENT_NONE, "", "snoozed an alert"); }
  void operator()(const FinishRequest&) const {
    Say(console::EVENT_FINISH, "", "finished the maze");
  }
  void operator()(const GoalsRequest& goals) const {
    Say(console::EVENT_GOALS, goals.robot, GoalsText(goals.add.size(), goals.remove.size()));
  }
  void operator()(const DriveRequest& drive) const {
    Say(console::EVENT_NONE, drive.robot, "drove");
  }
  void operator()(const SelectRequest& select) const {
    Say(console::EVENT_NONE, select.robot, "selected the robot");
  }
};

}  // namespace

console::Event EventOf(const OperatorRequest& request, const OperatorReply& reply) {
  console::Event event;
  std::visit(Describe{event}, request.body);
  event.set_client(request.client);
  event.set_world(request.world);
  event.set_revision(reply.revision);
  if (!reply.accepted) {
    event.set_text(fmt::format("refused ({}): {}", event.text(), reply.reason));
    event.set_kind(console::EVENT_REFUSED);
  }
  return event;
}

}  // namespace conav::operators
