#include "operator/operator_service.h"

/// The service's part in a mapping task or a study; see TaskDesk.
namespace conav::operators {

BeliefStore::Answer OperatorService::Finish(const OperatorRequest& request) {
  if (!task_) return {{request.client, request.request_id, false, "there is no task here", 0}};
  const bool was_finished = task_->finished();
  BeliefStore::Answer answer = task_->Finish(request);
  if (task_->finished() && !was_finished && segments_) segments_->Finish();
  return answer;
}

void OperatorService::FollowTask() {
  task_->Hear(control_.book());
  TaskStatus status = task_->status();
  if (!console_ || status == task_shown_) return;
  console_->Hear(status);
  task_shown_ = std::move(status);
}

}  // namespace conav::operators
