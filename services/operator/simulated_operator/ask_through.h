#pragma once

#include <variant>

#include "common/runtime/log.h"
#include "operator/client/operator_client.h"

namespace conav::operators {

/// Tells a synthetic person what came of its requests, and asks for what it wants next.
/// Does not block.
template <class Person>
void AskThrough(OperatorClient& client, Person& person, const Clock& clock) {
  for (const OperatorClient::Outcome& outcome : client.Poll()) {
    if (!outcome.reply) {
      LOG_WARNING("no reply", "reason", outcome.reply.error().text);
    } else if (!outcome.reply->accepted) {
      LOG_WARNING("refused", "id", outcome.request_id, "reason", outcome.reply->reason);
    }
    person.Answered(outcome.reply, clock.Now());
  }
  if (const auto ask = person.Next(clock.Now())) {
    std::visit([&](const auto& body) { client.Send(ask->world, body, ask->stamp); }, ask->body);
  }
}

}  // namespace conav::operators
