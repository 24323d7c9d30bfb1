#include "operator/operator_service.h"

/// The service's part in the mapping task; see TaskDesk.
namespace conav::operators {

BeliefStore::Answer OperatorService::Finish(const OperatorRequest& request) {
  if (!task_) return {{request.client, request.request_id, false, "there is no task here", 0}};
  BeliefStore::Answer answer = task_->Finish(request);
  if (answer.changed && segments_) segments_->Finish();
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
