#include <catch2/catch.hpp>
#include <optional>
#include <thread>

#include "common/msg/convert.h"
#include "operator/operator_service.h"
#include "operator/simulated/operator_client.h"
#include "planner/planner_service.h"
#include "sim/sim_service.h"
#include "support/loopback.h"
#include "support/temporary_folder.h"

/// A key press on its way over real DDS: client, operator service, planner, simulator, and back as a
/// state and a streamed picture.
namespace conav {
namespace {

using namespace std::chrono_literals;

sim::SimConfig Streaming() {
  sim::SimConfig config;
  config.seed = 9;
  config.camera.mode = "none";
  config.camera.stream = true;
  return config;
}

planner::PlannerConfig Teleoperation() {
  planner::PlannerConfig config;
  config.method = MethodKind::kTeleop;
  config.perception = "embedded";
  config.perception_model = PerceptionModelKind::kGlpf;
  return config;
}

operators::OperatorConfig StoringIn(const test::TemporaryFolder& folder) {
  operators::OperatorConfig config;
  config.database = (folder / "operator.db").string();
  return config;
}

class Field {
 public:
  /// `vendors`: of simulator, operator service, planner and client.
  explicit Field(const std::array<std::string, 4>& vendors)
      : sim_bus_("sim", test::OnLoopback(vendors[0])),
        operator_bus_("operator", test::OnLoopback(vendors[1])),
        planner_bus_("planner", test::OnLoopback(vendors[2])),
        client_bus_("client", test::OnLoopback(vendors[3])) {
    // The camera belongs to the thread that makes the service; there is none here.
    threads_.emplace_back([this] { sim_.Run(stop_); });
    threads_.emplace_back([this] { operator_.Run(stop_); });
    threads_.emplace_back([this] { planner_.Run(stop_); });
  }
  ~Field() {
    stop_.RequestStop();
    for (auto* bus : {&sim_bus_, &operator_bus_, &planner_bus_}) bus->Wake();
  }

  /// The reply to a key, asked again while the service does not know the robot yet.
  OperatorReply Press(DriveAction drive, SimTime expires_at) {
    OperatorReply reply;
    const bool answered = Until([&] {
      if (client_.pending() == 0) client_.Send("w1", DriveRequest{"r1", drive, expires_at}, {});
      for (const auto& outcome : client_.Poll()) {
        if (!outcome.reply) continue;
        reply = *outcome.reply;
        if (reply.reason.find("has not reported") == std::string::npos) return true;
      }
      return false;
    });
    CHECK(answered);
    return reply;
  }

  /// Waits for a state in which `order` was carried out.
  std::optional<RobotState> StateAfter(std::uint64_t order) {
    const bool there = Until([&] {
      for (RobotState& state : state_.TakeValid(kDomain)) newest_ = std::move(state);
      for (Snapshot& snapshot : snapshot_.TakeValid(kDomain))
        snapshots.push_back(std::move(snapshot));
      return newest_ && newest_->drive_order == order &&
             newest_->command_outcome != CommandOutcome::kRunning &&
             snapshots.size() >= newest_->snapshots;
    });
    return there ? newest_ : std::nullopt;
  }

  std::vector<Snapshot> snapshots;

 private:
  static constexpr auto kDomain = [](const auto& message) { return ToDomain(message); };

  template <class Condition>
  bool Until(Condition&& condition) {
    const auto deadline = std::chrono::steady_clock::now() + 30s;
    while (!condition()) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      client_bus_.Wait(50ms);
    }
    return true;
  }

  test::TemporaryFolder folder_;
  SteadyClock clock_;
  StopToken stop_;
  bus::Participant sim_bus_;
  bus::Participant operator_bus_;
  bus::Participant planner_bus_;
  bus::Participant client_bus_;
  sim::SimService sim_{sim_bus_, Streaming(), clock_};
  operators::OperatorService operator_{operator_bus_, StoringIn(folder_), clock_};
  planner::PlannerService planner_{planner_bus_, Teleoperation(), clock_};
  operators::OperatorClient client_{client_bus_, clock_, {"tester", 0.25, 10.0}};
  bus::Subscriber<conav_msgs::msg::RobotState> state_{client_bus_, bus::kRobotState, "r1"};
  bus::Subscriber<conav_msgs::msg::Snapshot> snapshot_{client_bus_, bus::kSnapshot, "r1"};
  std::optional<RobotState> newest_;
  std::vector<std::jthread> threads_;
};

TEST_CASE("a key is one control step and one picture, on every vendor", "[teleoperation]") {
  const std::string c = "cyclonedds";
  const std::string f = "fastdds";
  using Vendors = std::array<std::string, 4>;
  Field field(GENERATE_COPY(Vendors{c, c, c, c}, Vendors{f, f, f, f}, Vendors{c, f, c, f}));
  SimTime now;
  for (std::uint64_t key = 1; key <= 5; ++key) {
    const OperatorReply reply = field.Press(DriveAction::kTurnLeft, now + 2s);
    REQUIRE(reply.accepted);
    const auto state = field.StateAfter(reply.revision);
    REQUIRE(state);
    CHECK(state->command_outcome == CommandOutcome::kDone);
    CHECK(state->low_level_steps == key);
    CHECK(state->images == key);
    CHECK(field.snapshots.back().streamed);
    CHECK(field.snapshots.back().heading_rad == Approx(state->heading_rad));
    now = state->stamp;
  }
  const OperatorReply late = field.Press(DriveAction::kForward, now);
  CHECK_FALSE(late.accepted);
  CHECK_THAT(late.reason, Catch::Contains("expired"));
}

}  // namespace
}  // namespace conav
