#include <fmt/core.h>

#include <limits>
#include <utility>

#include "common/msg/convert.h"
#include "common/msg/convert_checks.h"

namespace conav {

using convert::Checks;
using convert::ToCellMessage;
using convert::WriteAddress;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::max();

RewardTerms ToTerms(Checks& checks, const std::string& at,
                    const conav_msgs::msg::RewardTerms& message) {
  RewardTerms terms;
  terms.goals = checks.Finite(at + "goals", message.goals());
  terms.steps = checks.Finite(at + "steps", message.steps());
  terms.progress = checks.Finite(at + "progress", message.progress());
  terms.guidance = checks.Finite(at + "guidance", message.guidance());
  terms.smoothness = checks.Finite(at + "smoothness", message.smoothness());
  terms.information = checks.Finite(at + "information", message.information());
  terms.communication = checks.Finite(at + "communication", message.communication());
  return terms;
}

SearchAction ToAction(Checks& checks, const std::string& at,
                      const conav_msgs::msg::SearchAction& message) {
  SearchAction action;
  action.kind = checks.Enumerator(at + "kind", message.kind(), CommandKind::kMove,
                                  CommandKind::kTransmitView);
  action.target = checks.ToCell(at + "target", message.target());
  action.heading_rad = checks.Heading(at + "heading", message.heading());
  action.visits = message.visits();
  action.mean_value = checks.Finite(at + "mean_value", message.mean_value());
  action.information_gain =
      checks.Range(at + "information_gain", message.information_gain(), 0.0, kInfinity);
  action.feasibility = checks.Range(at + "feasibility", message.feasibility(), 0.0, 1.0);
  action.terms = ToTerms(checks, at + "terms.", message.terms());
  return action;
}

std::vector<SearchAction> ToActions(Checks& checks,
                                    const std::vector<conav_msgs::msg::SearchAction>& messages) {
  std::vector<SearchAction> actions;
  checks.Size("actions", messages.size(), convert::kMaxActions);
  for (std::size_t i = 0; i < messages.size() && !checks.failed(); ++i) {
    actions.push_back(ToAction(checks, fmt::format("actions[{}].", i), messages[i]));
  }
  return actions;
}

ReportedNode ToNode(Checks& checks, const std::string& at, int index,
                    const conav_msgs::msg::SearchNode& message) {
  ReportedNode node;
  node.parent = message.parent();
  // Only the first node has no parent, and a parent precedes its children: so this is one tree
  // without loops.
  if (node.parent < (index == 0 ? -1 : 0) || node.parent >= index) {
    checks.Refuse(fmt::format("{}parent = {} is not {}", at, node.parent,
                              index == 0 ? "-1" : fmt::format("in [0, {}]", index - 1)));
  }
  node.kind = checks.Enumerator(at + "kind", message.kind(), CommandKind::kMove,
                                CommandKind::kTransmitView);
  node.target = checks.ToCell(at + "target", message.target());
  node.heading_rad = checks.Heading(at + "heading", message.heading());
  node.visits = message.visits();
  node.mean_value = checks.Finite(at + "mean_value", message.mean_value());
  node.feasibility = checks.Range(at + "feasibility", message.feasibility(), 0.0, 1.0);
  return node;
}

std::vector<ReportedNode> ToTree(Checks& checks,
                                 const std::vector<conav_msgs::msg::SearchNode>& messages) {
  std::vector<ReportedNode> tree;
  checks.Size("tree", messages.size(), kMaxReportedNodes);
  for (std::size_t i = 0; i < messages.size() && !checks.failed(); ++i) {
    tree.push_back(ToNode(checks, fmt::format("tree[{}].", i), static_cast<int>(i), messages[i]));
  }
  return tree;
}

std::vector<ReportedView> ToViews(Checks& checks,
                                  const std::vector<conav_msgs::msg::SearchView>& messages) {
  std::vector<ReportedView> views;
  checks.Size("views", messages.size(), kMaxReportedViews);
  for (std::size_t i = 0; i < messages.size() && !checks.failed(); ++i) {
    const std::string at = fmt::format("views[{}].", i);
    views.push_back(
        {checks.ToCell(at + "cell", messages[i].cell()),
         checks.Heading(at + "heading", messages[i].heading()),
         checks.Range(at + "information_gain", messages[i].information_gain(), 0.0, kInfinity)});
  }
  return views;
}

conav_msgs::msg::RewardTerms ToTermsMessage(const RewardTerms& terms) {
  conav_msgs::msg::RewardTerms message;
  message.goals(terms.goals);
  message.steps(terms.steps);
  message.progress(terms.progress);
  message.guidance(terms.guidance);
  message.smoothness(terms.smoothness);
  message.information(terms.information);
  message.communication(terms.communication);
  return message;
}

conav_msgs::msg::SearchNode ToNodeMessage(const ReportedNode& node) {
  conav_msgs::msg::SearchNode message;
  message.parent(node.parent);
  message.kind(static_cast<std::uint8_t>(node.kind));
  message.target(ToCellMessage(node.target));
  message.heading(node.heading_rad);
  message.visits(node.visits);
  message.mean_value(node.mean_value);
  message.feasibility(node.feasibility);
  return message;
}

}  // namespace

Result<SearchReport> ToDomain(const conav_msgs::msg::SearchReport& message) {
  Checks checks;
  SearchReport report;
  checks.Address(message, report);
  report.method = checks.Client("method", message.method());
  report.decision = message.decision();
  report.cell = checks.ToCell("cell", message.cell());
  report.belief_revision = message.belief_revision();
  report.guidance_revision = message.guidance_revision();
  report.actions = ToActions(checks, message.actions());
  report.has_terms = message.has_terms();
  report.tree = ToTree(checks, message.tree());
  report.views = ToViews(checks, message.views());
  report.chosen = message.chosen();
  if (message.chosen() < -1 || message.chosen() >= static_cast<int>(message.actions().size())) {
    checks.Refuse(fmt::format("chosen = {} is not in [-1, {}]", message.chosen(),
                              static_cast<int>(message.actions().size()) - 1));
  }
  report.iterations = message.iterations();
  report.nodes = message.nodes();
  report.perception_queries = message.perception_queries();
  report.perception_cached = message.perception_cached();
  report.perception_model = checks.Text("perception_model", message.perception_model());
  report.duration_ms = checks.Range("duration_ms", message.duration_ms(), 0.0, kInfinity);
  return checks.OrFailure(std::move(report));
}

conav_msgs::msg::SearchReport ToMessage(const SearchReport& report) {
  conav_msgs::msg::SearchReport message;
  WriteAddress(report, message);
  message.method(report.method);
  message.decision(report.decision);
  message.cell(ToCellMessage(report.cell));
  message.belief_revision(report.belief_revision);
  message.guidance_revision(report.guidance_revision);
  for (const SearchAction& action : report.actions) {
    auto& out = message.actions().emplace_back();
    out.kind(static_cast<std::uint8_t>(action.kind));
    out.target(ToCellMessage(action.target));
    out.heading(action.heading_rad);
    out.visits(action.visits);
    out.mean_value(action.mean_value);
    out.information_gain(action.information_gain);
    out.feasibility(action.feasibility);
    out.terms(ToTermsMessage(action.terms));
  }
  message.chosen(report.chosen);
  message.has_terms(report.has_terms);
  for (const ReportedNode& node : report.tree) message.tree().push_back(ToNodeMessage(node));
  for (const ReportedView& view : report.views) {
    auto& out = message.views().emplace_back();
    out.cell(ToCellMessage(view.cell));
    out.heading(view.heading_rad);
    out.information_gain(view.information_gain);
  }
  message.iterations(report.iterations);
  message.nodes(report.nodes);
  message.perception_queries(report.perception_queries);
  message.perception_cached(report.perception_cached);
  message.perception_model(report.perception_model);
  message.duration_ms(report.duration_ms);
  return message;
}

}  // namespace conav
