#include <limits>
#include <set>
#include <utility>

#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"
#include "common/runtime/result.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::ToCellMessages;

namespace {

PerceptionQuery ToQuery(Checks& checks, const std::string& at,
                        const conav_msgs::msg::PerceptionQuery& message, std::uint32_t rows,
                        std::uint32_t columns) {
  PerceptionQuery query;
  query.belief = checks.Probabilities(at + "belief", message.belief(), static_cast<int>(rows),
                                      static_cast<int>(columns));
  query.path = checks.Cells(at + "path", message.path(), convert::kMaxPath, rows, columns);
  query.cell = checks.ToCell(at + "cell", message.cell(), rows, columns);
  query.heading_rad = checks.Heading(at + "heading", message.heading());
  query.visible = checks.Visible(at, message.free_cells(), message.wall_cells(), rows, columns);
  return query;
}

PerceptionRequest ToSender(Checks& checks, const conav_msgs::msg::PerceptionRequest& message) {
  PerceptionRequest request;
  request.client = checks.Client("client", message.client());
  request.request_id = message.request_id();
  if (request.request_id == 0) checks.Refuse("request_id = 0 is below 1");
  return request;
}

/// Rejects batches that would make the service allocate without bound.
bool CheckBatch(Checks& checks, const conav_msgs::msg::PerceptionRequest& message) {
  checks.Size("queries", message.queries().size(), convert::kMaxQueries);
  if (checks.failed() || message.queries().empty()) return !checks.failed();
  if (!checks.Shape(message.rows(), message.columns())) return false;
  const std::size_t cells = std::size_t{message.rows()} * message.columns();
  checks.Size("queries * rows * columns", message.queries().size() * cells,
              convert::kMaxQueryValues);
  return !checks.failed();
}

void EachOnce(Checks& checks, const char* field, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) checks.Refuse(fmt::format("{}: {} appears twice", field, name));
  }
}

std::vector<PlannerLease::Held> ToHeldRobots(
    Checks& checks, const std::vector<conav_msgs::msg::HeldRobot>& messages) {
  std::vector<PlannerLease::Held> holds;
  std::vector<std::string> names;
  checks.Size("holds", messages.size(), convert::kMaxRobots);
  for (std::size_t i = 0; i < messages.size() && !checks.failed(); ++i) {
    const std::string at = fmt::format("holds[{}].", i);
    names.push_back(checks.Name(at + "robot", messages[i].robot()));
    if (messages[i].lease_epoch() == 0) checks.Refuse(at + "lease_epoch = 0 is below 1");
    holds.push_back({names.back(), messages[i].lease_epoch()});
  }
  EachOnce(checks, "holds", names);
  return holds;
}

}  // namespace

Result<PerceptionRequest> SenderOf(const conav_msgs::msg::PerceptionRequest& message) {
  Checks checks;
  PerceptionRequest sender = ToSender(checks, message);
  return checks.OrFailure(std::move(sender));
}

Result<PerceptionRequest> ToDomain(const conav_msgs::msg::PerceptionRequest& message) {
  Checks checks;
  PerceptionRequest request = ToSender(checks, message);
  request.replica = checks.OptionalClient("replica", message.replica());
  request.model = checks.Text("model", message.model());
  request.model_checksum = checks.Checksum("model_checksum", message.model_checksum());
  request.person = checks.OptionalName("person", message.person());
  request.timeout_ms = message.timeout_ms();
  if (!CheckBatch(checks, message)) return checks.failure();
  request.queries.reserve(message.queries().size());
  for (std::size_t i = 0; i < message.queries().size() && !checks.failed(); ++i) {
    request.queries.push_back(ToQuery(checks, fmt::format("queries[{}].", i), message.queries()[i],
                                      message.rows(), message.columns()));
  }
  return checks.OrFailure(std::move(request));
}

conav_msgs::msg::PerceptionRequest ToMessage(const PerceptionRequest& request) {
  conav_msgs::msg::PerceptionRequest message;
  message.client(request.client);
  message.request_id(request.request_id);
  message.replica(request.replica);
  message.model(request.model);
  message.model_checksum(request.model_checksum);
  message.person(request.person);
  message.timeout_ms(request.timeout_ms);
  if (request.queries.empty()) return message;
  const BeliefGrid& first = request.queries.front().belief;
  message.rows(static_cast<std::uint32_t>(first.rows()));
  message.columns(static_cast<std::uint32_t>(first.columns()));
  message.queries().reserve(request.queries.size());
  for (const PerceptionQuery& query : request.queries) {
    DEMAND(query.belief.rows() == first.rows() && query.belief.columns() == first.columns(),
           query.belief.rows(), query.belief.columns(), first.rows(), first.columns());
    auto& out = message.queries().emplace_back();
    out.belief(convert::ToFloats(query.belief));
    out.path(ToCellMessages(query.path));
    out.cell(ToCellMessage(query.cell));
    out.heading(query.heading_rad);
    out.free_cells(ToCellMessages(query.visible.free));
    out.wall_cells(ToCellMessages(query.visible.walls));
  }
  return message;
}

Result<PerceptionReply> ToDomain(const conav_msgs::msg::PerceptionReply& message, int rows,
                                 int columns) {
  Checks checks;
  PerceptionReply reply;
  reply.client = checks.Client("client", message.client());
  reply.request_id = message.request_id();
  reply.replica = checks.OptionalClient("replica", message.replica());
  reply.status =
      checks.Enumerator("status", message.status(), PerceptionStatus::kOk, PerceptionStatus::kBusy);
  reply.reason = checks.Text("reason", message.reason());
  reply.model = checks.Text("model", message.model());
  reply.model_version = checks.Text("model_version", message.model_version());
  reply.model_checksum = checks.Checksum("model_checksum", message.model_checksum());
  checks.Size("answers", message.answers().size(), convert::kMaxQueries);
  for (std::size_t i = 0; i < message.answers().size() && !checks.failed(); ++i) {
    const auto& answer = message.answers()[i];
    const std::string at = fmt::format("answers[{}].", i);
    reply.answers.push_back({checks.Probabilities(at + "add", answer.add(), rows, columns),
                             checks.Probabilities(at + "remove", answer.remove(), rows, columns)});
  }
  return checks.OrFailure(std::move(reply));
}

conav_msgs::msg::PerceptionReply ToMessage(const PerceptionReply& reply) {
  conav_msgs::msg::PerceptionReply message;
  message.client(reply.client);
  message.request_id(reply.request_id);
  message.replica(reply.replica);
  message.status(static_cast<std::uint8_t>(reply.status));
  message.reason(reply.reason);
  message.model(reply.model);
  message.model_version(reply.model_version);
  message.model_checksum(reply.model_checksum);
  message.answers().reserve(reply.answers.size());
  for (const PerceptionAnswer& answer : reply.answers) {
    auto& out = message.answers().emplace_back();
    out.add(convert::ToFloats(answer.add));
    out.remove(convert::ToFloats(answer.remove));
  }
  return message;
}

using convert::Checks;

Result<PlannerLease> ToDomain(const conav_msgs::msg::PlannerLease& message) {
  Checks checks;
  PlannerLease lease;
  lease.node = checks.Client("node", message.node());
  lease.instance = checks.Client("instance", message.instance());
  checks.Size("robots", message.robots().size(), convert::kMaxRobots);
  for (std::size_t i = 0; i < message.robots().size() && !checks.failed(); ++i) {
    lease.robots.push_back(checks.Name(fmt::format("robots[{}]", i), message.robots()[i]));
  }
  EachOnce(checks, "robots", lease.robots);
  lease.holds = ToHeldRobots(checks, message.holds());
  lease.load = checks.Range("load", message.load(), 0.0,
                            static_cast<double>(std::numeric_limits<int>::max()));
  lease.leaving = message.leaving();
  if (lease.leaving && !lease.holds.empty())
    checks.Refuse("leaving is true, but holds lists robots");
  return checks.OrFailure(std::move(lease));
}

conav_msgs::msg::PlannerLease ToMessage(const PlannerLease& lease) {
  conav_msgs::msg::PlannerLease message;
  message.node(lease.node);
  message.instance(lease.instance);
  message.robots(lease.robots);
  for (const PlannerLease::Held& held : lease.holds) {
    conav_msgs::msg::HeldRobot robot;
    robot.robot(held.robot);
    robot.lease_epoch(held.lease_epoch);
    message.holds().push_back(robot);
  }
  message.load(lease.load);
  message.leaving(lease.leaving);
  return message;
}

Result<IntendedPath> ToDomain(const conav_msgs::msg::IntendedPath& message) {
  Checks checks;
  IntendedPath path;
  path.robot = checks.Name("robot", message.robot());
  path.cells = checks.Cells("cells", message.cells());
  path.room.cells = checks.Cells("room", message.room());
  path.room.right.tier = checks.Enumerator("room_tier", message.room_tier(), RightOfWay::kShutIn,
                                           RightOfWay::kHasNone);
  path.room.right.robot = checks.OptionalName("room_for", message.room_for());
  path.room.right.passed_on = message.room_passed_on();
  return checks.OrFailure(std::move(path));
}

conav_msgs::msg::IntendedPath ToMessage(const IntendedPath& path) {
  conav_msgs::msg::IntendedPath message;
  message.robot(path.robot);
  message.cells(convert::ToCellMessages(path.cells));
  message.room(convert::ToCellMessages(path.room.cells));
  message.room_tier(path.room.right.tier);
  message.room_for(path.room.right.robot);
  message.room_passed_on(path.room.right.passed_on);
  return message;
}

}  // namespace conav
