#include "nhpm/nhpm_service.h"

#include <fmt/format.h>

#include <bit>

#include "common/bus/send.h"
#include "common/protocol/convert.h"
#include "common/runtime/log.h"

namespace conav::nhpm {
namespace {

constexpr std::chrono::milliseconds kReceivePause{100};

/// The first, second, fourth, ... of many equal log lines.
bool WorthLogging(std::uint64_t count) { return std::has_single_bit(count); }

/// `client` and `request_id` alone, to find out whether a malformed request can be replied to.
bool NamesItsSender(const conav_msgs::msg::PerceptionRequest& message) {
  conav_msgs::msg::PerceptionRequest sender;
  sender.client(message.client());
  sender.request_id(message.request_id());
  return ToDomain(sender).has_value();
}

}  // namespace

NhpmService::NhpmService(bus::Participant& participant, const NhpmConfig& config,
                         const Clock& clock)
    : participant_(participant),
      clock_(clock),
      model_(config.glpf),
      diagnostics_(participant, clock),
      replies_(participant, bus::kPerceptionReply),
      requests_(participant, bus::kPerceptionRequest) {
  LOG_INFO("serving", "model", Glpf::name(), "version", model_.version());
}

void NhpmService::Run(const StopToken& stop) {
  while (!stop.stop_requested()) RunOnce(kReceivePause);
}

void NhpmService::RunOnce(std::chrono::nanoseconds timeout) {
  participant_.Wait(timeout);
  for (const auto& message : requests_.Take()) Answer(message);
  diagnostics_.Tick([this] { return Report(); });
}

void NhpmService::Answer(const conav_msgs::msg::PerceptionRequest& message) {
  const Clock::TimePoint start = clock_.Now();
  const auto request = ToDomain(message);
  PerceptionReply reply;
  if (request) {
    reply = ReplyTo(*request);
  } else if (NamesItsSender(message)) {
    reply = Blank(message.client(), message.request_id());
    reply.status = PerceptionStatus::kRefused;
    reply.reason = request.error().text;
  } else {
    if (WorthLogging(++counts_.dropped)) {
      LOG_WARNING("request dropped", "topic", bus::kPerceptionRequest.pattern, "reason",
                  request.error().text, "count", counts_.dropped);
    }
    return;
  }
  bus::Send(replies_, ToMessage(reply));
  counts_.busy += clock_.Now() - start;
  Count(reply);
}

PerceptionReply NhpmService::Blank(const std::string& client, std::uint64_t request_id) const {
  PerceptionReply reply;
  reply.client = client;
  reply.request_id = request_id;
  reply.model = Glpf::name();
  reply.model_version = model_.version();
  return reply;
}

PerceptionReply NhpmService::ReplyTo(const PerceptionRequest& request) const {
  PerceptionReply reply = Blank(request.client, request.request_id);
  const auto refuse = [&reply](std::string reason) {
    reply.status = PerceptionStatus::kRefused;
    reply.reason = std::move(reason);
  };
  if (!request.model.empty() && request.model != Glpf::name()) {
    refuse(fmt::format("model = '{}' is not served here, '{}' is", request.model, Glpf::name()));
    return reply;
  }
  auto answers = model_.Predict(request.queries);
  if (answers) {
    reply.answers = *std::move(answers);
  } else {
    refuse(answers.error().text);
  }
  return reply;
}

void NhpmService::Count(const PerceptionReply& reply) {
  if (reply.status == PerceptionStatus::kOk) {
    ++counts_.requests;
    counts_.queries += reply.answers.size();
    return;
  }
  if (WorthLogging(++counts_.refused)) {
    LOG_WARNING("request refused", "topic", bus::kPerceptionRequest.pattern, "client", reply.client,
                "request", reply.request_id, "reason", reply.reason, "count", counts_.refused);
  }
}

Health NhpmService::Report() const {
  const double busy_s = std::chrono::duration<double>(counts_.busy).count();
  return {Health::Level::kOk,
          fmt::format("serving {}", Glpf::name()),
          {{"model", Glpf::name()},
           {"model_version", model_.version()},
           {"requests", fmt::format("{}", counts_.requests)},
           {"queries", fmt::format("{}", counts_.queries)},
           {"refused", fmt::format("{}", counts_.refused)},
           {"dropped", fmt::format("{}", counts_.dropped + requests_.malformed())},
           {"busy_s", fmt::format("{:.3f}", busy_s)}}};
}

}  // namespace conav::nhpm
