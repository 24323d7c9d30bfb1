#include "planner/explain/explain_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <set>

#include "common/console/console.h"
#include "planner/explain/decision_json.h"
#include "planner/explain/decision_picture.h"
#include "planner/explain/run_decisions.h"

namespace conav::planner {
namespace {

constexpr const char* kProgram = "conav explain";

std::size_t CountRobots(const RunDecisions& decisions) {
  std::set<std::string> robots;
  for (const DecisionSummary& one : decisions.list) robots.insert(one.robot);
  return robots.size();
}

Result<void> Write(const ExplainArguments& arguments, const RunDecisions& decisions) {
  const bool single = decisions.one.has_value();
  const std::string text = single ? DecisionText(*decisions.one) : ListText(decisions.list);
  if (arguments.json == "-" || arguments.svg == "-") {
    fmt::print(stderr, "{}", text);
  } else if (auto printed = WriteStandardOutput(text); !printed) {
    return printed;
  }
  const auto json = single ? DecisionJson(*decisions.one) : ListJson(decisions.list);
  if (auto written = WriteJsonOutput(arguments.json, json); !written) return written;
  if (arguments.svg.empty()) return {};
  return WriteOutput(arguments.svg, DecisionSvg(*decisions.one));
}

int Explain(const ExplainArguments& arguments, const DecisionQuery& query) {
  const auto decisions = ReadRun(arguments.run, query);
  if (!decisions) return Failed(kProgram, decisions.error());
  for (const std::string& note : decisions->notes) Warn(kProgram, note);
  if (decisions->one && CountRobots(*decisions) > 1) {
    return Refused(kProgram, "several robots have such a decision; say which by --robot");
  }
  if (decisions->one && decisions->found > 1) {
    Warn(kProgram, fmt::format("there are {} of this number, as when a planner was started again; "
                               "this is the last",
                               decisions->found));
  }
  return ExitCode(kProgram, Write(arguments, *decisions));
}

}  // namespace

int RunExplain(const ExplainArguments& arguments) {
  DecisionQuery query{.robot = arguments.robot, .pictures_only = arguments.pictures};
  if (!arguments.decision.empty()) {
    const auto range = ParseDecisionRange(arguments.decision);
    if (!range) return Refused(kProgram, "--decision: " + range.error().text);
    query.range = *range;
  }
  if (!arguments.svg.empty() && !query.range.is_one()) {
    return Refused(kProgram, "--svg draws one decision; say which by --decision");
  }
  if (arguments.json == "-" && arguments.svg == "-") {
    return Refused(kProgram, "only one of --json and --svg can go to standard output");
  }
  const int code = CheckFiles(kProgram, {{"RUN", arguments.run}},
                              {{"--svg", arguments.svg}, {"--json", arguments.json}});
  if (code != 0) return code;
  return Explain(arguments, query);
}

}  // namespace conav::planner
