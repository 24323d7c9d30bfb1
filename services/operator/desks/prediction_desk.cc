#include "operator/desks/prediction_desk.h"

#include <algorithm>
#include <utility>

#include "common/bus/send.h"
#include "common/protocol/convert.h"
#include "operator/client/operator_client.h"

namespace conav::operators {
namespace {

constexpr std::uint32_t kTimeoutMs = 1000;

bool LiesIn(const Belief& belief, const Picture& picture) {
  const auto inside = [&](Cell cell) { return belief.wall_probability.Contains(cell); };
  return inside(picture.cell) && std::ranges::all_of(picture.path, inside) &&
         std::ranges::all_of(picture.visible.free, inside) &&
         std::ranges::all_of(picture.visible.walls, inside);
}

}  // namespace

PredictionDesk::PredictionDesk(bus::Participant& participant, const Clock& clock)
    : clock_(clock),
      client_(UniqueClientName("console")),
      requests_(participant, bus::kPerceptionRequest),
      replies_(participant, bus::kPerceptionReply) {}

void PredictionDesk::Ask(const Picture& picture, const Belief& belief) {
  if (!LiesIn(belief, picture)) return;
  Question question;
  question.of = {picture.robot, picture.world, picture.sequence_number, belief.revision, "", {}};
  question.rows = belief.wall_probability.rows();
  question.columns = belief.wall_probability.columns();
  question.request.client = client_;
  question.request.request_id = ++last_id_;
  question.request.timeout_ms = kTimeoutMs;
  question.request.queries = {
      {belief.wall_probability, picture.path, picture.cell, picture.heading_rad, picture.visible}};
  Send(open_[picture.robot] = std::move(question));
}

void PredictionDesk::Send(Question& question) {
  ++question.tries;
  question.repeat_at = clock_.Now() + kRepeat;
  bus::Send(requests_, ToMessage(question.request));
}

std::vector<Prediction> PredictionDesk::Step() {
  std::vector<Prediction> predictions;
  for (const auto& message : replies_.Take()) {
    if (message.client() != client_) continue;
    const auto asked = std::ranges::find_if(open_, [&](const auto& entry) {
      return entry.second.request.request_id == message.request_id();
    });
    if (asked == open_.end()) continue;
    const auto reply = ToDomain(message, asked->second.rows, asked->second.columns);
    if (!reply || reply->status != PerceptionStatus::kOk || reply->answers.size() != 1) continue;
    Prediction prediction = std::move(asked->second.of);
    prediction.model = reply->model;
    prediction.answer = reply->answers.front();
    predictions.push_back(std::move(prediction));
    open_.erase(asked);
  }
  for (auto entry = open_.begin(); entry != open_.end();) {
    if (clock_.Now() >= entry->second.repeat_at && entry->second.tries >= kTries) {
      entry = open_.erase(entry);
      continue;
    }
    if (clock_.Now() >= entry->second.repeat_at) Send(entry->second);
    ++entry;
  }
  return predictions;
}

}  // namespace conav::operators
