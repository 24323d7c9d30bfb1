#include "common/msg/supervision.h"

#include <utility>

#include "common/msg/checks.h"

namespace conav {
namespace {

constexpr double kLongest = 1.0e6;  // s

/// Checks the body of a request; makes texts readable.
struct CheckBody {
  convert::ValueChecks& checks;

  void Robots(const std::vector<std::string>& robots) const {
    checks.Size("robots", robots.size(), convert::kMaxRobots);
    for (std::size_t i = 0; i < robots.size() && !checks.failed(); ++i) {
      checks.Name(fmt::format("robots[{}]", i), robots[i]);
    }
  }
  void operator()(const EditRequest& edit) const {
    checks.Size("edits", edit.edits.size(), convert::kMaxPath);
    for (std::size_t i = 0; i < edit.edits.size() && !checks.failed(); ++i) {
      checks.Inside(fmt::format("edits[{}].cell", i), edit.edits[i].cell);
    }
  }
  void operator()(const GuideRequest& guide) const {
    checks.Name("robot", guide.robot);
    checks.Size("path", guide.path.size(), convert::kMaxPath);
    checks.Inside("path", guide.path);
    checks.Positive("valid_for", guide.valid_for_s, kLongest);
  }
  void operator()(const DriveRequest& drive) const {
    checks.Name("robot", drive.robot);
    checks.Enumerator("drive", static_cast<std::uint8_t>(drive.drive), DriveAction::kStop,
                      DriveAction::kTurnRight);
  }
  void operator()(const SelectRequest& select) const {
    checks.Name("robot", select.robot);
    checks.Enumerator("attention_reason", static_cast<std::uint8_t>(select.reason),
                      AttentionReason::kSnapshot, AttentionReason::kGoalsReached);
  }
  void operator()(const AnswerRequest& answer) const {
    checks.AtLeastOne("answers_snapshot", answer.snapshot);
    checks.Name("robot", answer.robot);
  }
  void operator()(StopRequest& stop) const {
    Robots(stop.robots);
    stop.reason = checks.Text("reason", stop.reason);
  }
  void operator()(const ResumeRequest& resume) const { Robots(resume.robots); }
  void operator()(TakeControlRequest& take) const {
    Robots(take.robots);
    take.reason = checks.Text("reason", take.reason);
  }
  void operator()(const ReleaseControlRequest& release) const {
    Robots(release.robots);
    if (!release.to_client.empty()) checks.Client("to_client", release.to_client);
  }
  void operator()(const AcknowledgeRequest&) const {}
  void operator()(const ShelveRequest& shelve) const {
    checks.Positive("duration", shelve.duration_s, kLongest);
  }
  void operator()(const FinishRequest&) const {}
  void operator()(const GoalsRequest& goals) const {
    checks.Name("robot", goals.robot);
    checks.InFrame("add_goals", goals.add);
    checks.InFrame("remove_goals", goals.remove);
  }
  void operator()(NoteRequest& note) const {
    note.text = checks.Text("reason", note.text);
    if (note.text.empty()) checks.Refuse("reason = '': a note needs a text");
  }
};

bool NamesWorld(const OperatorRequest& request) {
  return std::holds_alternative<EditRequest>(request.body) ||
         std::holds_alternative<GuideRequest>(request.body) ||
         std::holds_alternative<DriveRequest>(request.body) ||
         std::holds_alternative<SelectRequest>(request.body) ||
         std::holds_alternative<AnswerRequest>(request.body) ||
         std::holds_alternative<GoalsRequest>(request.body);
}

}  // namespace

Result<OperatorRequest> Checked(OperatorRequest request) {
  convert::ValueChecks checks;
  checks.Client("client", request.client);
  checks.AtLeastOne("request_id", request.request_id);
  std::visit(CheckBody{checks}, request.body);
  NamesWorld(request) ? checks.Name("world", request.world)
                      : checks.OptionalName("world", request.world);
  return checks.OrFailure(std::move(request));
}

OperatorReply Refusal(const OperatorRequest& request, std::string reason, std::uint64_t revision) {
  return {request.client, request.request_id, false, std::move(reason), revision};
}

}  // namespace conav
