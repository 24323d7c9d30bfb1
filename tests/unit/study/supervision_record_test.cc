#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "study/supervision_player.h"

namespace conav::study {
namespace {

/// No field at its default.
SupervisionRecord FullRecord() {
  SupervisionRecord record{.trial = {4, "fifo", 7}, .failure = "sim-w1 died", .attempts = 2};
  record.minutes = 2.5;
  record.goals = 11.0;
  record.wall_s = 8.25;
  record.pace = 0.97;
  record.workload = {.robots = 4,
                     .interactions = 12,
                     .abandoned = 3,
                     .observed_s = 150.0,
                     .busy_s = 90.0,
                     .interaction_time_s = 5.5,
                     .neglect_time_s = 20.5,
                     .waiting_time_s = 3.5,
                     .waiting_time_p95_s = 9.5,
                     .value_lost = 1.0 / 3.0,
                     .utilisation = 0.6,
                     .attended_robots = 3.1,
                     .fan_out = 4.7,
                     .fan_out_with_waits = 3.3,
                     .predicted_utilisation = 0.65,
                     .predicted_waiting_time_s = 2.75};
  return record;
}

TEST_CASE("A trial's record is read back as it was written", "[study][supervision]") {
  SupervisionRecord read;
  REQUIRE(FromJson(ToJson(FullRecord()).dump(), read));
  CHECK(read == FullRecord());
  CHECK(ToJson(read)["name"] == "n04-fifo-seed7");
  CHECK(ToJson(read)["operator"] == "simulated");
}

TEST_CASE("A trial's record that lacks something is refused with what it lacks",
          "[study][supervision]") {
  SupervisionRecord read;
  for (const char* key : {"robots", "order", "failure", "pace", "workload"}) {
    auto json = ToJson(FullRecord());
    json.erase(key);
    const auto parsed = FromJson(json.dump(), read);
    REQUIRE_FALSE(parsed);
    CHECK_THAT(parsed.error().text, Catch::Contains(key));
  }
  const std::string whole = ToJson(FullRecord()).dump();
  CHECK_FALSE(FromJson(whole.substr(0, whole.size() / 2), read));
}

}  // namespace
}  // namespace conav::study
