#pragma once

#include <catch2/catch.hpp>

#include "integration/operator/hand_made_sim.h"
#include "operator/client/operator_client.h"

namespace conav::operators {

/// The service on an in-memory bus with a hand-made simulator and one client.
struct OperatorBench {
  explicit OperatorBench(const std::filesystem::path& database)
      : sim(bus),
        operator_participant("operator", bus),
        client_participant("client", bus),
        service(operator_participant, ConfigFor(database), clock),
        client(client_participant, clock, {"anna", 0.25, 10.0}) {}

  /// The reply to a request that was just sent.
  OperatorReply Settle(std::uint64_t id) {
    service.Step();
    for (const auto& outcome : client.Poll()) {
      REQUIRE(outcome.reply.has_value());
      if (outcome.request_id == id) return *outcome.reply;
    }
    FAIL("no reply to request " << id);
    return {};
  }

  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  HandMadeSim sim;
  bus::Participant operator_participant;
  bus::Participant client_participant;
  OperatorService service;
  OperatorClient client;
};

}  // namespace conav::operators
