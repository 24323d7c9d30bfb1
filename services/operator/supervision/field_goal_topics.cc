#include "operator/supervision/field_goal_topics.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "common/msg/convert.h"

namespace conav::operators {
namespace {

/// So long both may be there when a program that publishes goals was killed and started again: the
/// lease by which the bus notices, and some more.
constexpr std::chrono::seconds kSettled{15};
constexpr const char* kGoalPoseClient = "goal_pose";

std::map<std::string, std::string> RobotsOf(const OperatorConfig& config) {
  const auto world_of_robot = config.world_of_robot();
  std::map<std::string, std::string> kept;
  for (const std::string& robot : config.goals.robots) {
    const auto found = world_of_robot.find(robot);
    if (found == world_of_robot.end()) {
      throw StartupError(
          fmt::format("operator.goals.robots: '{}' is not a robot of operator.robots", robot));
    }
    kept.insert(*found);
  }
  return kept;
}

Mission MissionOf(const GoalOptions& options) {
  if (options.mission.empty()) return {};
  auto mission = ReadMission(options.mission, options.robots);
  if (!mission) throw StartupError("operator.goals.mission: " + mission.error().text);
  return *std::move(mission);
}

}  // namespace

FieldGoalTopics::FieldGoalTopics(bus::Participant& participant, const OperatorConfig& config,
                                 BeliefStore& store, const Clock& clock)
    : participant_(participant),
      store_(store),
      clock_(clock),
      goals_(RobotsOf(config), config.goals, MissionOf(config.goals), store.goals()) {
  for (const auto& [robot, world] : config.world_of_robot()) {
    links_[robot].goal_pose = std::make_unique<bus::Subscriber<geometry_msgs::msg::PoseStamped>>(
        participant, bus::kGoalPose, robot);
  }
}

BeliefStore::Answer FieldGoalTopics::Answer(const OperatorRequest& request) {
  const auto& body = std::get<GoalsRequest>(request.body);
  const auto link = links_.find(body.robot);
  if (link != links_.end() && link->second.others_publish) {
    return {Refusal(request, fmt::format("another program publishes the goals of {}", body.robot))};
  }
  const auto kept = goals_.Change(body);
  if (!kept) return {Refusal(request, kept.error().text)};
  BeliefStore::Answer answer = store_.Keep(request, {}, {}, {*kept});
  if (!answer.changed) return answer;
  goals_.Adopt(*kept);
  Publish(*kept);
  return answer;
}

void FieldGoalTopics::Publish(const KeptGoals& kept) {
  Link& link = links_.at(kept.goals.robot);
  if (!link.goals && link.others_publish) return;
  if (!link.goals) {
    link.goals = std::make_unique<bus::Publisher<conav_msgs::msg::RobotGoals>>(
        participant_, bus::kRobotGoals, kept.goals.robot);
  }
  bus::Send(*link.goals, ToMessage(kept.goals));
}

void FieldGoalTopics::CountPublishers(const std::string& robot, int publishers) {
  Link& link = links_.at(robot);
  const bool is_kept_here = goals_.robots().contains(robot);
  const int allowed = is_kept_here && !link.goals ? 0 : 1;
  const bool others = publishers > allowed;
  if (others && !link.others_publish) link.others_since = clock_.Now();
  link.others_publish = others;
  LogProblem(robot);
}

void FieldGoalTopics::Receive(const RobotState& state, int publishers) {
  CountPublishers(state.robot, publishers);
  links_.at(state.robot).in_field = state.goals_stamp == SimTime{};
  const auto before = goals_.robots().find(state.robot);
  if (before == goals_.robots().end()) return;
  const std::size_t reached = before->second.kept.goals.reached.size();
  const auto kept = goals_.Receive(state);
  Link& link = links_.at(state.robot);
  if (before->second.keeps_goals) link.goals.reset();
  const bool missing = !link.goals && !before->second.keeps_goals;
  if (!kept && !missing) return;
  if (kept) {
    if (kept->goals.reached.size() > reached) {
      LOG_INFO("goal reached", "robot", state.robot, "goals_left", kept->goals.left.size(), "sim_s",
               state.stamp.ToSeconds());
    }
    if (const auto saved = store_.SaveGoals(*kept); !saved) {
      LOG_WARNING("goals not stored", "robot", state.robot, "reason", saved.error().text);
    }
  }
  Publish(before->second.kept);
}

void FieldGoalTopics::Step(const ControlRegistry& control) {
  for (auto& [robot, link] : links_) {
    const auto poses = link.goal_pose->TakeValid(kToDomain);
    if (poses.empty()) continue;
    if (goals_.robots().contains(robot)) {
      TakeGoalPose(robot, poses.back(), control);
    } else if (link.in_field) {
      WarnOfIgnored(robot);
    }
  }
}

void FieldGoalTopics::WarnOfIgnored(const std::string& robot) {
  const auto held_back = links_.at(robot).ignored.Allow(clock_.Now());
  if (!held_back) return;
  LOG_WARNING("goal pose ignored: name the robot in operator.goals.robots", "robot", robot, "topic",
              bus::kGoalPose.NameFor(robot), "held_back", *held_back);
}

void FieldGoalTopics::TakeGoalPose(const std::string& robot, Position goal,
                                   const ControlRegistry& control) {
  const FieldGoals::Robot& one = goals_.robots().at(robot);
  if (one.keeps_goals) return;  // its planner takes it as guidance
  std::string refusal = control.CheckCommand(kGoalPoseClient, robot, clock_.Now());
  if (refusal.empty() && links_.at(robot).others_publish) refusal = ProblemOf(robot);
  Result<KeptGoals> kept = Fail(ErrorCode::kRefused, refusal);
  if (refusal.empty()) kept = goals_.Change({robot, {goal}, one.kept.goals.left});
  if (kept) {
    if (const auto saved = store_.SaveGoals(*kept); !saved) kept = tl::unexpected(saved.error());
  }
  if (!kept) {
    LOG_WARNING("goal pose refused", "robot", robot, "reason", kept.error().text);
    return;
  }
  LOG_INFO("goal pose taken as the robot's goal", "robot", robot, "x_m", goal.x_m, "y_m", goal.y_m);
  goals_.Adopt(*kept);
  Publish(*kept);
}

std::string FieldGoalTopics::ProblemOf(const std::string& robot) const {
  const auto found = links_.find(robot);
  if (found == links_.end()) return "";
  const auto kept = goals_.robots().find(robot);
  if (kept != goals_.robots().end()) {
    if (kept->second.keeps_goals) {
      return fmt::format("{} keeps its goals itself, but operator.goals.robots names it", robot);
    }
    if (!kept->second.outside.empty()) {
      return fmt::format("{} lost {}", robot, kept->second.outside);
    }
  }
  const bool settled = clock_.Now() - found->second.others_since >= kSettled;
  if (!found->second.others_publish || !settled) return "";
  return fmt::format("more than one program publishes /{}/goals", robot);
}

void FieldGoalTopics::LogProblem(const std::string& robot) {
  std::string problem = ProblemOf(robot);
  if (problem == links_.at(robot).logged) return;
  if (!problem.empty()) LOG_ERROR("goals", "robot", robot, "problem", problem);
  links_.at(robot).logged = std::move(problem);
}

void FieldGoalTopics::AddTo(Health& health) const {
  for (const auto& [robot, one] : goals_.robots()) {
    health.values.emplace_back(robot + "/goals_left", std::to_string(one.kept.goals.left.size()));
  }
}

}  // namespace conav::operators
