#include <catch2/catch.hpp>
#include <csignal>

#include "common/bus/subscriber.h"
#include "support/dds_participant.h"
#include "support/nhpm_process.h"

namespace conav {
namespace {

/// Until a line of conav-nhpm on /rosout begins with `text`.
void WaitForLine(bus::Participant& participant,
                 bus::Subscriber<rcl_interfaces::msg::Log>& subscriber, const std::string& text) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (true) {
    REQUIRE(std::chrono::steady_clock::now() < deadline);
    participant.Wait(std::chrono::milliseconds(100));
    for (const auto& line : subscriber.Take()) {
      if (line.name() == "nhpm_test" && line.msg().starts_with(text)) return;
    }
  }
}

}  // namespace

TEST_CASE("a service writes its log on /rosout, also for who comes late and until its end",
          "[nhpm]") {
  const std::string vendor = GENERATE("cyclonedds", "fastdds");
  const std::string listener = vendor == "fastdds" ? "cyclonedds" : "fastdds";
  INFO(vendor << " received by " << listener);
  test::NhpmProcess service(vendor);
  const auto participant = test::OverDds(listener)("listener");
  bus::Subscriber<rcl_interfaces::msg::Log> subscriber(*participant, bus::kRosout);
  WaitForLine(*participant, subscriber, "running");
  CHECK(service.End(SIGTERM) == 0);
  WaitForLine(*participant, subscriber, "stopped");
}

}  // namespace conav
