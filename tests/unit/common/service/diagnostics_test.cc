#include "common/service/diagnostics.h"

#include <catch2/catch.hpp>

namespace conav {
namespace {

diagnostic_msgs::msg::DiagnosticStatus Status(std::uint8_t level, const std::string& process,
                                              const std::string& message) {
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level(level);
  status.hardware_id(process);
  status.message(message);
  return status;
}

TEST_CASE("what conav's processes say is taken up readably, others are left out", "[service]") {
  diagnostic_msgs::msg::DiagnosticArray message;
  message.status({Status(1, "sim", "slow"), Status(2, "", "a battery"), Status(3, "nhpm", "\xFF")});
  const auto all = HealthOf(message);
  REQUIRE(all.size() == 2);
  CHECK(all[0].process == "sim");
  CHECK(all[0].level == Health::Level::kWarning);
  CHECK(all[0].message == "slow");
  CHECK(all[1].process == "nhpm");
  CHECK(all[1].level == Health::Level::kError);  // stale, to ROS
  CHECK(all[1].message == "?");
}

}  // namespace
}  // namespace conav
