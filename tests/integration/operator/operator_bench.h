#pragma once

#include <catch2/catch.hpp>

#include "integration/operator/hand_made_sim.h"
#include "operator/simulated/operator_client.h"

namespace conav::operators {

/// The service on an in-memory bus with a hand-made simulator and one client.
struct OperatorBench {
  /// A `config` without a database gets one in a folder of its own.
  explicit OperatorBench(OperatorConfig config = ConfigFor(""))
      : sim(bus),
        operator_participant("operator", bus),
        client_participant("client", bus),
        service(operator_participant, WithDatabase(std::move(config)), clock),
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
  template <class Body>
  OperatorReply Ask(const Body& body) {
    return Settle(client.Send("w1", body, {}));
  }

  TemporaryFolder folder;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  FakeClock clock;
  HandMadeSim sim;
  bus::Participant operator_participant;
  bus::Participant client_participant;
  OperatorService service;
  OperatorClient client;

 private:
  OperatorConfig WithDatabase(OperatorConfig config) const {
    if (config.database.empty()) config.database = (folder / "operator.db").string();
    return config;
  }
};

}  // namespace conav::operators
