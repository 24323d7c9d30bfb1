#include "planner/explain/decision_json.h"

#include "planner/explain/action_names.h"
#include "planner/explain/explanation.h"

namespace conav::planner {
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
                    {"picture", one.picture},
                    {"searched", one.searched},
                    {"visit_share", one.visit_share},
                    {"value", one.value},
                    {"margin", one.margin},
                    {"information_gain", one.information_gain}});
  }
  return json;
}

}  // namespace conav::planner
