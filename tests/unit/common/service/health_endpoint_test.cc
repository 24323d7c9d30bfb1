#include "common/service/health_endpoint.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>

#include "common/bus/in_memory_bus.h"
#include "support/temporary_folder.h"
#include "support/wait.h"

namespace conav {
namespace {

using namespace std::chrono_literals;

/// A clock that other threads may read while it is set.
class SharedClock final : public Clock {
 public:
  TimePoint Now() const override { return TimePoint(offset_.load()); }
  void Advance(std::chrono::nanoseconds by) { offset_ = offset_.load() + by; }

 private:
  std::atomic<std::chrono::nanoseconds> offset_{1h};
};

struct Probed {
  explicit Probed(const std::string& name = "planner") : participant(name, bus) {}

  /// Sends `request` and returns all that comes back.
  std::string Send(const std::string& request) const {
    const int client = socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof address.sun_path - 1);
    REQUIRE(connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    REQUIRE(send(client, request.data(), request.size(), 0) > 0);
    std::string answer;
    char bytes[1024];
    for (ssize_t count = 1; count > 0;) {
      count = recv(client, bytes, sizeof bytes, 0);
      if (count > 0) answer.append(bytes, static_cast<std::size_t>(count));
    }
    close(client);
    return answer;
  }
  std::string Get(const std::string& target) const {
    return Send("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }

  test::TemporaryFolder folder;
  std::filesystem::path path = folder / "health.sock";
  SharedClock clock;
  std::shared_ptr<bus::InMemoryBus> bus = std::make_shared<bus::InMemoryBus>();
  bus::Participant participant;
  std::optional<HealthEndpoint> endpoint{std::in_place, participant, clock, path.string()};
};

TEST_CASE("a service answers probes as it reports itself", "[service]") {
  Probed probed;
  Diagnostics diagnostics(probed.participant, probed.clock);
  bus::Participant peer("sim", probed.bus);
  Diagnostics other(peer, probed.clock);
  CHECK_THAT(probed.Get("/livez"), Catch::StartsWith("HTTP/1.1 200"));  // it has not begun
  CHECK_THAT(probed.Get("/readyz"), Catch::StartsWith("HTTP/1.1 503"));
  const auto report = [&](Health::Level level, const std::string& message) {
    probed.clock.Advance(1s);
    diagnostics.Tick([&] {
      return Health{level, message, {{"w1/decisions", "7"}, {"driver", "none"}}};
    });
    other.Tick([] { return Health{Health::Level::kWarning, "slow", {}}; });
  };
  report(Health::Level::kOk, "fine");
  CHECK_THAT(probed.Get("/readyz"), Catch::StartsWith("HTTP/1.1 200") &&
                                        Catch::Contains("\"message\":\"fine\"") &&
                                        Catch::Contains("\"sim\":\"warning\""));
  CHECK_THAT(probed.Get("/metrics?x=1"),
             Catch::Contains("conav_health_level{process=\"sim\"} 1\n") &&
                 Catch::Contains("\nconav_w1_decisions 7\n") && !Catch::Contains("driver"));
  report(Health::Level::kError, "no model");
  CHECK_THAT(probed.Get("/readyz"),
             Catch::StartsWith("HTTP/1.1 503") && Catch::Contains("no model"));
  CHECK_THAT(probed.Get("/livez"), Catch::StartsWith("HTTP/1.1 200"));
  probed.clock.Advance(4s);
  CHECK_THAT(probed.Get("/livez"), Catch::StartsWith("HTTP/1.1 503"));
  CHECK_THAT(probed.Get("/readyz"), Catch::Contains("\"sim\":\"silent\""));
  probed.endpoint.reset();
  CHECK_FALSE(std::filesystem::exists(probed.path));
}

TEST_CASE("metrics outlast reports that have no values", "[service]") {
  Probed probed;
  bus::Publisher<diagnostic_msgs::msg::DiagnosticArray> reports(probed.participant,
                                                                bus::kDiagnostics);
  using Values = std::vector<std::pair<std::string, std::string>>;
  for (const Values& values : {Values{{"started", "1"}, {"w1/decisions", "7"}},
                               Values{{"started", "1"}, {"clock", "1 2 host"}}}) {
    diagnostic_msgs::msg::DiagnosticStatus status;
    status.name("planner: health");
    status.hardware_id("planner");
    for (const auto& [key, value] : values) {
      status.values().emplace_back();
      status.values().back().key(key);
      status.values().back().value(value);
    }
    diagnostic_msgs::msg::DiagnosticArray array;
    array.status().push_back(status);
    REQUIRE(reports.Publish(array));
    CHECK_THAT(probed.Get("/metrics"), Catch::Contains("\nconav_w1_decisions 7\n"));
  }
}

TEST_CASE("what is no request for a known page harms no other client", "[service]") {
  Probed probed;
  for (const char* request : {"GET /nothing HTTP/1.1\r\n\r\n", "POST /livez HTTP/1.1\r\n\r\n",
                              "\r\n\r\n", "GET \r\n\r\n"}) {
    CHECK_THAT(probed.Send(request), Catch::StartsWith("HTTP/1.1 404"));
  }
  CHECK(probed.Send("GET /livez").empty());  // it never ends
  CHECK_THAT(probed.Get("/livez"), Catch::StartsWith("HTTP/1.1 200"));
}

TEST_CASE("an address at which nothing can listen stops the start", "[service]") {
  Probed probed;
  for (const std::string& address :
       {std::string("0"), std::string("70000"), (probed.folder / "none/health.sock").string(),
        std::string(200, 'a')}) {
    CHECK_THROWS_WITH(HealthEndpoint(probed.participant, probed.clock, address),
                      Catch::StartsWith("--health " + address));
  }
}

}  // namespace
}  // namespace conav
