#include <catch2/catch.hpp>

#include "operator/recording/recorder_service.h"

namespace conav::recorder {
namespace {

struct Desk {
  std::uint64_t time = 100;
  int woken = 0;
  Arrivals arrivals{40, [this] { ++woken; }, [this] { return time; }};
};

TEST_CASE("Arrivals come in order, with their time and stamp", "[operator][recorder]") {
  Desk desk;
  desk.arrivals.Add(1, 7, bag::Bytes(4));
  desk.time = 200;
  desk.arrivals.Add(2, std::nullopt, bag::Bytes(5));
  const auto taken = desk.arrivals.Take();
  REQUIRE(taken.size() == 2);
  CHECK(taken[0].channel == 1);
  CHECK(taken[0].log_time == 100);
  CHECK(taken[0].publish_time == 7);
  CHECK(taken[0].data.size() == 4);
  CHECK(taken[1].log_time == 200);
  CHECK(taken[1].publish_time == 200);
  CHECK(desk.arrivals.Take().empty());
}

TEST_CASE("What a slow writer cannot take is dropped and counted", "[operator][recorder]") {
  Desk desk;
  for (int i = 0; i < 5; ++i) desk.arrivals.Add(1, 0, bag::Bytes(10));
  CHECK(desk.arrivals.dropped() == 1);
  CHECK(desk.arrivals.Take().size() == 4);
  desk.arrivals.Add(1, 0, bag::Bytes(40));
  CHECK(desk.arrivals.Take().size() == 1);
  CHECK(desk.arrivals.dropped() == 1);
}

TEST_CASE("The writer is woken when much waits", "[operator][recorder]") {
  Desk desk;
  desk.arrivals.Add(1, 0, bag::Bytes(10));
  CHECK(desk.woken == 0);
  desk.arrivals.Add(1, 0, bag::Bytes(1));
  CHECK(desk.woken == 1);
}

}  // namespace
}  // namespace conav::recorder
