#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "common/bus/send.h"
#include "common/protocol/convert.h"
#include "operator/console/wall_seconds.h"
#include "operator/operator_links.h"

namespace conav::operators {
namespace {

/// Pages' requests that wait for the map of their world.
constexpr std::size_t kWaitingLimit = 64;

/// Low-level actions and selections are void as soon as they are old, and are not stored.
bool IsStored(const OperatorRequest& request) {
  return !std::holds_alternative<DriveRequest>(request.body) &&
         !std::holds_alternative<SelectRequest>(request.body);
}

/// Edits, guides or answers.
bool IsOfWorld(const OperatorRequest& request) {
  return std::holds_alternative<EditRequest>(request.body) ||
         std::holds_alternative<GuideRequest>(request.body) ||
         std::holds_alternative<AnswerRequest>(request.body);
}

OperatorReply Refusal(const OperatorRequest& request, std::string why) {
  return {request.client, request.request_id, false, std::move(why), 0};
}

/// Of a request that guides or answers.
const std::string& GuidedRobot(const OperatorRequest& request) {
  const auto* answer = std::get_if<AnswerRequest>(&request.body);
  return answer != nullptr ? answer->robot : std::get<GuideRequest>(request.body).robot;
}

}  // namespace

// --- where they come from --------------------------------------------------------------------

void OperatorService::AnswerBus() {
  const std::vector<OperatorRequest> requests =
      requests_.TakeValid([](const auto& message) { return ToDomain(message); });
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const auto reply = Answer(requests[i], "", ReplacedBy(requests, i));
    if (reply) bus::Send(replies_, ToMessage(*reply));
  }
}

void OperatorService::AnswerConsole() {
  std::vector<ConsoleDesk::Asked> asked = std::exchange(waiting_, {});
  std::ranges::move(console_->Step(), std::back_inserter(asked));
  // After Step(): who is back by now has not gone.
  for (const std::string& client : console_->TakeGone()) control_.Leave(client);
  for (const std::string& client : console_->TakeActive()) control_.Renew(client);
  std::vector<OperatorRequest> requests;
  for (ConsoleDesk::Asked& one : asked) requests.push_back(std::move(one.request));
  for (std::size_t i = 0; i < asked.size(); ++i) {
    OperatorRequest& request = requests[i];
    const auto reply = Answer(request, asked[i].why_not, ReplacedBy(requests, i));
    const bool may_wait = WallSeconds() <= asked[i].valid_until_s;
    if (!reply && may_wait && waiting_.size() < kWaitingLimit) {
      asked[i].request = std::move(request);
      waiting_.push_back(std::move(asked[i]));
      continue;
    }
    console_->Reply(asked[i].page,
                    reply ? *reply
                          : Refusal(request, fmt::format("world {} is not known yet: its map has "
                                                         "not come",
                                                         request.world)));
  }
}

// --- what is decided -------------------------------------------------------------------------

std::optional<OperatorReply> OperatorService::Answer(const OperatorRequest& request,
                                                     std::string_view why_not,
                                                     const OperatorRequest* replaced_by) {
  if (IsStored(request)) {
    if (const auto repeat = store_.FindRepeat(request)) {
      NoteStorage(*repeat);
      return repeat->reply;
    }
  }
  if (!why_not.empty()) return Tell(request, {Refusal(request, std::string(why_not))});
  if (IsOfWorld(request)) {
    const WorldLink* world = FindWorld(request.world);
    if (world != nullptr && !world->served() && world->refusal.empty()) return std::nullopt;
  }
  std::string why = control_.WhyNot(request);
  if (why.empty() && task_) why = task_->WhyNot(request);
  if (!why.empty()) return Tell(request, {Refusal(request, std::move(why))});
  control_.Renew(request.client);
  return Decide(request, replaced_by);
}

OperatorReply OperatorService::Decide(const OperatorRequest& request,
                                      const OperatorRequest* replaced_by) {
  if (AlertDesk::Handles(request)) return Tell(request, alerts_.Answer(request, WallSeconds()));
  if (ControlDesk::Handles(request)) {
    return Tell(request, control_.Answer(request, OperatorTime()));
  }
  if (std::holds_alternative<FinishRequest>(request.body)) return Tell(request, Finish(request));
  if (std::holds_alternative<DriveRequest>(request.body)) return PassOn(request, replaced_by);
  if (std::holds_alternative<SelectRequest>(request.body)) {
    return Tell(request, {attention_.Select(request, OperatorTime())});
  }
  const WorldLink* world = FindWorld(request.world);
  if (world != nullptr && !world->served())
    return Tell(request, {Refusal(request, world->refusal)});
  const BeliefStore::Answer answer = store_.Handle(request, TimeOf(request.world));
  if (answer.changed) PublishChange(request);
  if (answer.changed && segments_) Record(request);
  return Tell(request, answer);
}

OperatorReply OperatorService::PassOn(const OperatorRequest& request,
                                      const OperatorRequest* replaced_by) {
  if (replaced_by != nullptr) {
    return Tell(request, {Refusal(request, fmt::format("replaced by request {}, which came at once",
                                                       replaced_by->request_id))});
  }
  const DriveGate::Answer answer = drive_gate_.Handle(request, TimeOf(request.world), clock_.Now());
  for (const auto& robot : robots_) {
    if (answer.order && robot->name == answer.order->robot) {
      bus::Send(robot->drive, ToMessage(*answer.order));
    }
  }
  return Tell(request, {answer.reply});
}

// --- who hears of it -------------------------------------------------------------------------

void OperatorService::PublishChange(const OperatorRequest& request) {
  if (std::holds_alternative<EditRequest>(request.body)) {
    attention_.Edited(request.client, request.world, OperatorTime());
    if (WorldLink* world = FindWorld(request.world)) PublishBelief(*world);
    return;
  }
  const auto* answer = std::get_if<AnswerRequest>(&request.body);
  const std::string& name = GuidedRobot(request);
  if (console_ && answer != nullptr) console_->Hear(*answer, request.client);
  attention_.Guided(request.client, *store_.FindGuidance(name), OperatorTime());
  for (const auto& robot : robots_) {
    if (robot->name == name) PublishGuidance(*robot);
  }
}

void OperatorService::Record(const OperatorRequest& request) {
  if (std::holds_alternative<EditRequest>(request.body)) {
    segments_->Edited(*store_.FindBelief(request.world));
  } else {
    segments_->Guided(*store_.FindGuidance(GuidedRobot(request)));
  }
}

OperatorReply OperatorService::Tell(const OperatorRequest& request,
                                    const BeliefStore::Answer& answer) {
  NoteStorage(answer);
  const bool is_news = journal_.Note(request, answer, TimeOf(request.world));
  if (console_ && is_news) console_->Hear(request, answer.reply);
  return answer.reply;
}

void OperatorService::NoteStorage(const BeliefStore::Answer& answer) {
  if (answer.written) storage_failure_ = "";
  if (!answer.storage_failure.empty()) storage_failure_ = answer.storage_failure;
}

}  // namespace conav::operators
