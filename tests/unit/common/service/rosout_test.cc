#include <catch2/catch.hpp>
#include <future>

#include "common/bus/in_memory_bus.h"
#include "common/bus/subscriber.h"
#include "common/service/service_main.h"

namespace conav {
namespace {

using namespace std::chrono_literals;

struct Bench {
  std::vector<rcl_interfaces::msg::Log> Lines(std::size_t count) {
    std::vector<rcl_interfaces::msg::Log> lines;
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (lines.size() < count && std::chrono::steady_clock::now() < deadline) {
      listener.Wait(100ms);
      for (auto& line : subscriber.Take()) lines.push_back(std::move(line));
    }
    return lines;
  }

  std::shared_ptr<bus::InMemoryBus> memory = std::make_shared<bus::InMemoryBus>();
  bus::Participant process{"planner-2", memory};
  bus::Participant listener{"listener", memory};
  bus::Subscriber<rcl_interfaces::msg::Log> subscriber{listener, bus::kRosout};
};

TEST_CASE("what is logged goes out on /rosout, with the name of the ROS graph and ROS 2's levels",
          "[service]") {
  Bench bench;
  const Rosout rosout(bench.process);
  log::SetMinimumLevel(log::Level::kDebug);
  LOG_DEBUG("a");
  LOG_INFO("b");
  LOG_WARNING("goal pose refused", "robot", "r1", "cells", 3);
  LOG_ERROR("d");
  log::SetMinimumLevel(log::Level::kInfo);
  LOG_DEBUG("below the minimum");
  const auto lines = bench.Lines(4);
  REQUIRE(lines.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(lines[i].level() == 10 * (i + 1));
  CHECK(lines[2].name() == "planner_2");
  CHECK(lines[2].msg() == "goal pose refused robot=r1 cells=3");
  CHECK(lines[2].stamp().sec() > 1'600'000'000);
}

TEST_CASE("the last lines go out before the end, later ones and those for stderr nowhere",
          "[service]") {
  Bench bench;
  {
    const Rosout rosout(bench.process);
    for (int i = 0; i < 50; ++i) LOG_INFO("line", "number", i);
    log::Write(log::Level::kError, "sending failed", "", log::Reach::kStderr);
  }
  LOG_INFO("after the end");
  const auto lines = bench.subscriber.Take();
  REQUIRE(lines.size() == 50);
  CHECK(lines.back().msg() == "line number=49");
}

TEST_CASE("a process that logs faster than the bus takes says how many lines it left out",
          "[service]") {
  // The bus is held up by a handler, as by a slow peer, while more lines come than may wait.
  Bench bench;
  std::mutex held;
  std::vector<std::string> lines;
  const bus::Subscriber<rcl_interfaces::msg::Log> subscriber{
      bench.listener, bus::kRosout, {}, [&](rcl_interfaces::msg::Log&& line) {
        const std::lock_guard lock(held);
        lines.push_back(line.msg());
      }};
  const Rosout rosout(bench.process);
  {
    const std::lock_guard lock(held);
    for (std::size_t i = 0; i < Rosout::kQueueLimit + 100; ++i) LOG_INFO("line", "number", i);
  }
  const auto all_came = [&] {
    const std::lock_guard lock(held);
    return !lines.empty() && lines.back() == "line number=1099";
  };
  const auto deadline = std::chrono::steady_clock::now() + 60s;
  while (!all_came() && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  const std::lock_guard lock(held);
  // At most one line was on its way when the queue began to fill.
  CHECK(lines.size() >= Rosout::kQueueLimit);
  CHECK(lines.size() <= Rosout::kQueueLimit + 1);
  CHECK(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.find("lines left out)") != std::string::npos;
  }));
  CHECK(lines.back() == "line number=1099");
}

TEST_CASE("the end does not wait long for a bus that takes no lines", "[service]") {
  // As a publisher whose peer has stalled: each line is refused after a while.
  std::promise<void> never;
  const auto acknowledged = never.get_future();
  int tried = 0;
  {
    const Rosout rosout("planner", [&](const rcl_interfaces::msg::Log&) {
      ++tried;
      acknowledged.wait_for(50ms);
      return false;
    });
    for (int i = 0; i < 100; ++i) LOG_INFO("line", "number", i);
  }
  CHECK(tried < 100);
}

}  // namespace
}  // namespace conav
