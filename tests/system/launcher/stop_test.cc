#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <optional>

#include "common/bus/publisher.h"
#include "common/runtime/text.h"
#include "common/service/robot_state_topics.h"
#include "operator/simulated/operator_client.h"
#include "support/loopback.h"
#include "system/launcher/demo_run.h"

// The faults report's S1: "Forged HoldOrder{stopped:false} lets a stopped robot drive"; S2: "A command with
// a higher epoch is carried out while stopped"; S3: "lease_epoch = 2^64-1 freezes a robot for good"; and
// "STOP, planner hung: last movement after 4.2 s".
namespace conav::testing {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kLast = std::numeric_limits<std::uint64_t>::max();

/// A person's client, and a program that forges what planner and operator service say of r1.
class Intruder {
 public:
  Intruder() : participant_("intruder", test::OnLoopback("cyclonedds")) {}

  const RobotState& state() const { return *state_; }

  /// Asks as a person; the request is repeated while the intruder looks on.
  template <class Request>
  void Ask(Request request) {
    person_.Send("w1", std::move(request), {});
  }
  bool Sees(const std::function<bool(const RobotState&)>& condition) {
    return WaitUntil(
        [&] {
          person_.Poll();
          for (auto& state : states_.TakeStamped()) state_ = std::move(state.value);
          return state_ && condition(*state_);
        },
        30s);
  }
  void Resume(std::uint64_t revision) {
    REQUIRE(stops_.Publish(ToMessage(StopOrder{state_->stamp, "w1", "r1", revision, false})));
  }
  void Drive(std::uint64_t lease_epoch) {
    RobotCommand command;
    command.stamp = state_->stamp;
    command.robot = "r1";
    command.sequence_number = state_->command_sequence_number + 1;
    command.lease_epoch = lease_epoch;
    command.expires_at = state_->stamp + 60s;
    command.kind = CommandKind::kDrive;
    command.drive = DriveAction::kForward;
    REQUIRE(commands_.Publish(ToMessage(command)));
  }

 private:
  SteadyClock clock_;
  bus::Participant participant_;
  RobotStateTopics states_{participant_, "r1"};
  operators::OperatorClient person_{participant_, clock_, {UniqueId()}};
  bus::Publisher<conav_msgs::msg::StopOrder> stops_{participant_, bus::kStopOrder, "r1"};
  bus::Publisher<conav_msgs::msg::RobotCommand> commands_{participant_, bus::kRobotCommand, "r1"};
  std::optional<RobotState> state_;
};

bool Stands(const RobotState& state) { return state.stopped && std::abs(state.speed_mps) < 0.01; }

}  // namespace

TEST_CASE("a stopped robot stands until a person resumes it, whatever comes over the bus",
          "[demo][stop]") {
  const bool planner_hangs = GENERATE(false, true);
  DemoRun demo("--headless --speed 1 --camera none --method greedy");
  const pid_t planner = demo.PidOf("planner");
  Intruder intruder;
  REQUIRE(intruder.Sees([](const RobotState& state) { return state.cell_moves > 0; }));
  if (planner_hangs) REQUIRE(kill(planner, SIGSTOP) == 0);
  intruder.Ask(StopRequest{{"r1"}, "people"});
  REQUIRE(intruder.Sees(Stands));
  const RobotState stood = intruder.state();

  for (const std::uint64_t epoch : {stood.lease_epoch, stood.lease_epoch + 1, kLast}) {
    const std::uint64_t steps = intruder.state().low_level_steps;
    intruder.Drive(epoch);
    const SimTime until = intruder.state().stamp + 1s;
    REQUIRE(intruder.Sees([&](const RobotState& state) { return state.stamp >= until; }));
    CHECK(intruder.state().low_level_steps == steps);
    CHECK(intruder.state().lease_epoch < kLast);
  }
  intruder.Resume(kLast);
  // The operator service stops again what another program resumes.
  const std::uint64_t forged = intruder.state().stop_revision + 1;
  intruder.Resume(forged);
  CHECK(intruder.Sees([&](const RobotState& state) {
    return state.stop_revision > forged && state.stop_revision < kLast && Stands(state);
  }));
  CHECK(intruder.state().cell == stood.cell);

  REQUIRE(kill(planner, SIGCONT) == 0);
  intruder.Ask(ResumeRequest{{"r1"}});
  CHECK(
      intruder.Sees([&](const RobotState& state) { return state.cell_moves > stood.cell_moves; }));
}

}  // namespace conav::testing
