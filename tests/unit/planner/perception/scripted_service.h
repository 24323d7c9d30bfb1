#pragma once

#include <atomic>
#include <catch2/catch.hpp>
#include <functional>
#include <memory>
#include <string>

#include "common/bus/in_memory_bus.h"
#include "common/msg/convert.h"
#include "conformance/perception_model_conformance.h"
#include "planner/perception/remote_model.h"

/// A perception service whose replies are in a test's hand, and who asks it.
namespace conav::planner::tests {

using conformance::MakeQueries;
using conformance::MakeQuery;
using RequestMessage = conav_msgs::msg::PerceptionRequest;
using ReplyMessage = conav_msgs::msg::PerceptionReply;
using std::chrono::milliseconds;

/// Replies in the test's hand: `on_request` is called inside of the asker's Publish().
class ScriptedService {
 public:
  using OnRequest = std::function<void(ScriptedService&, const RequestMessage&)>;

  ScriptedService(std::shared_ptr<bus::InMemoryBus> bus, OnRequest on_request)
      : participant_("nhpm", std::move(bus)),
        replies_(participant_, bus::kPerceptionReply),
        requests_(participant_, bus::kPerceptionRequest, {},
                  [this, on_request](RequestMessage&& message) {
                    ++asked;
                    on_request(*this, message);
                  }) {}

  void Reply(const ReplyMessage& message) { REQUIRE(replies_.Publish(message)); }

  std::atomic<int> asked{0};

 private:
  bus::Participant participant_;
  bus::Publisher<ReplyMessage> replies_;
  bus::Subscriber<RequestMessage> requests_;
};

/// A right reply: every probability is 0.5.
inline ReplyMessage HalfReply(const RequestMessage& request) {
  PerceptionReply reply{.client = request.client(),
                        .request_id = request.request_id(),
                        .replica = "nhpm",
                        .model = "half",
                        .model_version = "1",
                        .model_checksum = std::string(64, '5')};
  const Grid<float> half(static_cast<int>(request.rows()), static_cast<int>(request.columns()),
                         0.5F);
  for (std::size_t i = 0; i < request.queries().size(); ++i) reply.answers.push_back({half, half});
  return ToMessage(reply);
}

struct RemoteBench {
  explicit RemoteBench(ScriptedService::OnRequest on_request,
                       RemotePerceptionModel::Options options = Quick()) {
    service = std::make_unique<ScriptedService>(bus, std::move(on_request));
    model = std::make_unique<RemotePerceptionModel>(participant, options);
  }
  static RemotePerceptionModel::Options Quick() {
    return {.timeout = milliseconds(100),
            .retry_interval = milliseconds(10),
            .busy_pause = milliseconds(5)};
  }
  auto Ask() { return model->Predict(MakeQueries(2)); }

  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant{"planner", bus};
  std::unique_ptr<ScriptedService> service;
  std::unique_ptr<RemotePerceptionModel> model;
};

inline void ExpectFailure(RemoteBench& bench, ErrorCode code, const std::string& text) {
  const auto answers = bench.Ask();
  REQUIRE_FALSE(answers);
  CHECK(answers.error().code == code);
  CHECK(answers.error().text == text);
}

/// A reply that says only how it went.
inline ReplyMessage WithoutAnswers(const RequestMessage& request, std::uint8_t status,
                                   const std::string& reason) {
  ReplyMessage reply = HalfReply(request);
  reply.status(status);
  reply.reason(reason);
  reply.answers().clear();
  return reply;
}

inline ReplyMessage BusyReply(const RequestMessage& request) {
  return WithoutAnswers(request, conav_msgs::msg::PERCEPTION_STATUS_BUSY, "9 requests are open");
}

}  // namespace conav::planner::tests
