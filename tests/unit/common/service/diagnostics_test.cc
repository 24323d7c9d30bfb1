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

TEST_CASE("what conav's processes say is taken up, others are left out", "[service]") {
  diagnostic_msgs::msg::DiagnosticArray message;
  message.status({Status(1, "sim", "slow"), Status(2, "", "a battery"), Status(0, "nhpm", "ok")});
  const auto all = HealthOf(message);
  REQUIRE(all.size() == 2);
  CHECK(all[0].process == "sim");
  CHECK(all[0].level == Health::Level::kWarning);
  CHECK(all[0].message == "slow");
  CHECK(all[1].process == "nhpm");
  CHECK(HealthOf({}).empty());
}

TEST_CASE("a level above error is an error, and bytes that are no text are replaced", "[service]") {
  diagnostic_msgs::msg::DiagnosticArray message;
  message.status({Status(3, "sim", "\xFF")});
  const auto all = HealthOf(message);
  REQUIRE(all.size() == 1);
  CHECK(all[0].level == Health::Level::kError);
  CHECK(all[0].message == "?");
}

}  // namespace
}  // namespace conav
