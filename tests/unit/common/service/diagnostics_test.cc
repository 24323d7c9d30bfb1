#include "common/service/diagnostics.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <catch2/catch.hpp>

#include "common/bus/in_memory_bus.h"
#include "common/bus/ros_graph.h"
#include "common/bus/subscriber.h"
#include "support/scoped_variable.h"
#include "support/temporary_folder.h"

namespace conav {
namespace {

using namespace std::chrono_literals;

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

TEST_CASE("a service reports twice a second, and who reads it can tell one start from another",
          "[service]") {
  const auto bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("sim", bus);
  bus::Participant reader("reader", bus);
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> reports(reader, bus::kDiagnostics);
  FakeClock clock;
  clock.Advance(1s);
  const auto started = [&](Diagnostics& diagnostics) {
    diagnostics.Tick([] { return Health{}; });
    const auto taken = reports.Take();
    REQUIRE(taken.size() == 1);
    return HealthOf(taken[0])[0].started;
  };
  Diagnostics first(participant, clock);
  const std::string began = started(first);
  first.Tick([] { return Health{}; });
  CHECK(reports.Take().empty());
  clock.Advance(500ms);
  CHECK(started(first) == began);
  Diagnostics second(participant, clock);
  CHECK(started(second) != began);
}

TEST_CASE("a service whose readers are across a link reports every 0.8 s, its values every 5 s",
          "[service]") {
  const auto bus = std::make_shared<bus::InMemoryBus>();
  bus->SetOverLink();
  bus::Participant participant("sim", bus);
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> reports(participant, bus::kDiagnostics);
  FakeClock clock;
  clock.Advance(1s);
  Diagnostics diagnostics(participant, clock);
  const auto taken = [&] {
    diagnostics.Tick([] { return Health{.message = "well", .values = {{"figure", "1"}}}; });
    return reports.Take();
  };
  for (const std::size_t sent : {1U, 0U, 1U, 0U}) {
    CHECK(taken().size() == sent);
    clock.Advance(400ms);
  }
  const auto short_report = taken();
  REQUIRE(short_report.size() == 1);
  CHECK(HealthOf(short_report[0])[0].message == "well");
  CHECK(short_report[0].status()[0].values().size() == 1);  // the start
  clock.Advance(5s - 1600ms);
  CHECK(taken().at(0).status()[0].values().size() == 2);
}

TEST_CASE("a report answers the newest clock probe, by the clock of its own host", "[service]") {
  const auto bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant("sim", bus);
  bus::Participant reader("reader", bus);
  bus::Subscriber<diagnostic_msgs::msg::DiagnosticArray> reports(reader, bus::kDiagnostics);
  bus::Publisher probes(reader, bus::kClockProbe);
  FakeClock clock;
  const std::chrono::system_clock::time_point wrong(1000s);
  Diagnostics diagnostics(participant, clock,
                          [&] { return wrong + clock.Now().time_since_epoch(); });
  const auto answer = [&] {
    clock.Advance(500ms);
    diagnostics.Tick([] { return Health{}; });
    return HealthOf(reports.Take().at(0))[0].clock;
  };
  CHECK_FALSE(answer());
  for (const auto asked : {7s, 8s}) {
    rosgraph_msgs::msg::Clock probe;
    probe.clock(RosWallTime(asked));
    REQUIRE(probes.Publish(probe));
  }
  const auto answered = answer();
  REQUIRE(answered);
  CHECK(answered->asked == 8s);
  CHECK(answered->received_s == 1000.5);
  CHECK(answered->sent_s == 1001.0);
  CHECK(answered->host == bus::HostName());
  CHECK_FALSE(answer());
}

TEST_CASE("an answer that cannot be read is none", "[service]") {
  for (const char* text : {"", "1", "1 2", "x 2 host", "99999999999999999999 2 host"}) {
    diagnostic_msgs::msg::DiagnosticArray message;
    message.status({Status(0, "sim", "")});
    diagnostic_msgs::msg::KeyValue pair;
    pair.key("clock");
    pair.value(text);
    message.status()[0].values({pair});
    CHECK_FALSE(HealthOf(message)[0].clock);
  }
}

TEST_CASE("systemd receives messages by a path or an abstract name", "[service]") {
  const test::TemporaryFolder folder;
  for (const std::string& name : {(folder / "notify").string(), "@" + (folder / "n").string()}) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path, sizeof address.sun_path - 1);
    if (name[0] == '@') address.sun_path[0] = '\0';
    const int descriptor = socket(AF_UNIX, SOCK_DGRAM, 0);
    REQUIRE(bind(descriptor, reinterpret_cast<const sockaddr*>(&address),
                 static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size())) == 0);
    const test::ScopedVariable variable("NOTIFY_SOCKET", name.c_str());
    NotifySystemd("READY=1");
    char text[16]{};
    CHECK(recv(descriptor, text, sizeof text, MSG_DONTWAIT) == 7);
    CHECK(std::string(text) == "READY=1");
    close(descriptor);
  }
  NotifySystemd("READY=1");  // nobody listens
}

}  // namespace
}  // namespace conav
