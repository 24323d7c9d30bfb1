#include "planner/explain/decision_text.h"

#include <fmt/core.h>

#include <array>

#include "planner/explain/explanation.h"

namespace conav::planner {
namespace {

std::string CellsText(const std::vector<Cell>& cells) {
  std::string text;
  for (const Cell cell : cells) text += fmt::format(" {}", cell);
  return text;
}

std::string SituationText(const DecisionRecord& decision) {
  const SearchReport& report = decision.report;
  const std::string guidance =
      decision.guidance.empty()
          ? std::string("no guidance")
          : fmt::format("guidance revision {}: {} cells to {}", report.guidance_revision,
                        decision.guidance.size(), decision.guidance.back());
  return fmt::format(
      "decision {} of {} in {} at {:.2f} s, method {}\n"
      "cell {}, {} goals left:{}; {} cells since the last picture\n"
      "operator's map revision {}; {}\n",
      report.decision, report.robot, report.world, report.stamp.ToSeconds(), report.method,
      report.cell, decision.goals_left.size(), CellsText(decision.goals_left), decision.path.size(),
      report.belief_revision, guidance);
}

std::string SearchText(const SearchReport& report) {
  return fmt::format(
      "search: {} iterations, {} nodes, {} queries to {} ({} more looked up), {:.1f} ms\n",
      report.iterations, report.nodes, report.perception_queries, report.perception_model,
      report.perception_cached, report.duration_ms);
}

// As Named(), short.
constexpr std::array kColumns{"goals",    "steps",     "progress", "guidance",
                              "smoothn.", "informat.", "communic."};

std::string HeaderRow(bool has_terms) {
  std::string row = fmt::format("\n  {:26} {:>7} {:>9}", "action", "visits", "value");
  if (has_terms) {
    row += " =";
    for (const char* name : kColumns) row += fmt::format(" {:>9}", name);
  }
  return row + fmt::format(" {:>9}\n", "feasible");
}

std::string ActionRow(const SearchAction& action, const DecisionRecord& decision) {
  const char mark = IsSameCommand(action, decision.taken) ? '*' : ' ';
  std::string row = fmt::format("{} {:26}", mark, ActionName(action, decision.report.cell));
  if (action.visits == 0) {
    return row +
           (action.kind == CommandKind::kTransmitView
                ? fmt::format("   not worth it: information {:.2f}\n", action.information_gain)
                : std::string("   not tried\n"));
  }
  row += fmt::format(" {:7} {:9.2f}", action.visits, action.mean_value);
  if (decision.report.has_terms) {
    row += "  ";
    // + 0.0: no "-0.00" for a term that plays no part.
    for (const auto& [name, value] : Named(action.terms))
      row += fmt::format(" {:9.2f}", value + 0.0);
  }
  return row + fmt::format(" {:9.2f}\n", action.feasibility);
}

std::string TableText(const DecisionRecord& decision) {
  std::string text = HeaderRow(decision.report.has_terms);
  for (const SearchAction& action : RankedActions(decision.report)) {
    text += ActionRow(action, decision);
  }
  if (!decision.report.has_terms) {
    text +=
        "(what the values are made of was not recorded: planner.search.report: terms or tree)\n";
  }
  return text;
}

}  // namespace

std::string DecisionText(const DecisionRecord& decision) {
  std::string text = SituationText(decision);
  if (decision.has_search()) {
    text += SearchText(decision.report);
    text += TableText(decision);
  } else {
    text += fmt::format("command: {}\n", ActionName(decision.taken, decision.report.cell));
  }
  text += "\n";
  for (const std::string& sentence : Why(decision)) text += sentence + "\n";
  return text;
}

DecisionSummary Summarise(const DecisionRecord& decision) {
  const SearchReport& report = decision.report;
  DecisionSummary summary{.robot = report.robot,
                          .number = report.decision,
                          .time_s = report.stamp.ToSeconds(),
                          .cell = report.cell,
                          .action = ActionName(decision.taken, report.cell),
                          .snapshot = decision.sends_snapshot(),
                          .searched = decision.has_search()};
  const SearchAction* taken = TakenAction(decision);
  if (!summary.searched || taken == nullptr) return summary;
  double visits = 0.0;
  for (const SearchAction& action : report.actions) visits += action.visits;
  if (visits > 0.0) summary.visit_share = taken->visits / visits;
  summary.value = taken->mean_value;
  summary.margin = Margin(decision);
  summary.information_gain = taken->information_gain;
  return summary;
}

std::string ListText(std::span<const DecisionSummary> decisions) {
  std::string text =
      fmt::format("{:8} {:>8} {:>9}  {:9} {:26} {:>7} {:>9} {:>9}\n", "robot", "decision", "time s",
                  "cell", "action", "visits", "value", "margin");
  for (const DecisionSummary& one : decisions) {
    text += fmt::format("{:8} {:8} {:9.2f}  {:9} ", one.robot, one.number, one.time_s,
                        fmt::format("{}", one.cell));
    if (!one.searched) {
      text += fmt::format("{:26} no search\n", one.action);
      continue;
    }
    text += fmt::format("{:26} {:5.0f} % {:9.2f} {:9.2f}", one.action, 100.0 * one.visit_share,
                        one.value, one.margin);
    text += one.snapshot ? fmt::format("  information {:.2f}\n", one.information_gain) : "\n";
  }
  return text;
}

namespace {

using Json = nlohmann::ordered_json;

Json CellJson(Cell cell) { return {cell.row, cell.column}; }

Json CellsJson(const std::vector<Cell>& cells) {
  Json json = Json::array();
  for (const Cell cell : cells) json.push_back(CellJson(cell));
  return json;
}

Json CommandJson(CommandKind kind, Cell target, double heading_rad) {
  if (kind == CommandKind::kMove) return {{"kind", "move"}, {"target", CellJson(target)}};
  return {{"kind", "picture"}, {"cell", CellJson(target)}, {"heading_rad", heading_rad}};
}

Json ActionJson(const SearchAction& action, const DecisionRecord& decision) {
  Json json = CommandJson(action.kind, action.target, action.heading_rad);
  json["name"] = ActionName(action, decision.report.cell);
  json["taken"] = IsSameCommand(action, decision.taken);
  json["visits"] = action.visits;
  json["value"] = action.mean_value;
  json["information_gain"] = action.information_gain;
  json["feasibility"] = action.feasibility;
  if (!decision.report.has_terms) return json;
  for (const auto& [name, value] : Named(action.terms)) json["terms"][name] = value;
  return json;
}

Json TreeJson(const std::vector<ReportedNode>& tree) {
  Json json = Json::array();
  for (const ReportedNode& node : tree) {
    Json entry = CommandJson(node.kind, node.target, node.heading_rad);
    entry["parent"] = node.parent;
    entry["visits"] = node.visits;
    entry["value"] = node.mean_value;
    entry["feasibility"] = node.feasibility;
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace

Json DecisionJson(const DecisionRecord& decision) {
  const SearchReport& report = decision.report;
  Json json{{"robot", report.robot},
            {"world", report.world},
            {"decision", report.decision},
            {"time_s", report.stamp.ToSeconds()},
            {"method", report.method},
            {"cell", CellJson(report.cell)},
            {"goals_left", CellsJson(decision.goals_left)},
            {"path", CellsJson(decision.path)},
            {"belief_revision", report.belief_revision},
            {"guidance_revision", report.guidance_revision},
            {"guidance", CellsJson(decision.guidance)},
            {"plan", CellsJson(decision.plan)},
            {"taken", ActionName(decision.taken, report.cell)},
            {"searched", decision.has_search()},
            {"why", Why(decision)},
            {"margin", Margin(decision)},
            {"iterations", report.iterations},
            {"nodes", report.nodes},
            {"perception_queries", report.perception_queries},
            {"perception_cached", report.perception_cached},
            {"perception_model", report.perception_model},
            {"duration_ms", report.duration_ms},
            {"actions", Json::array()},
            {"tree", TreeJson(report.tree)},
            {"views", Json::array()}};
  if (decision.has_search()) {
    for (const SearchAction& action : RankedActions(report)) {
      json["actions"].push_back(ActionJson(action, decision));
    }
  }
  for (const ReportedView& view : report.views) {
    json["views"].push_back({{"cell", CellJson(view.cell)},
                             {"heading_rad", view.heading_rad},
                             {"information_gain", view.information_gain}});
  }
  return json;
}

Json ListJson(std::span<const DecisionSummary> decisions) {
  Json json = Json::array();
  for (const DecisionSummary& one : decisions) {
    json.push_back({{"robot", one.robot},
                    {"decision", one.number},
                    {"time_s", one.time_s},
                    {"cell", CellJson(one.cell)},
                    {"action", one.action},
                    {"picture", one.snapshot},
                    {"searched", one.searched},
                    {"visit_share", one.visit_share},
                    {"value", one.value},
                    {"margin", one.margin},
                    {"information_gain", one.information_gain}});
  }
  return json;
}

}  // namespace conav::planner
