#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "common/cli/cli.h"
#include "planner/explain/decision_text.h"
#include "planner/explain/explanation.h"

namespace conav::planner {
namespace {

/// The options of `conav explain`; empty = not given.
struct ExplainArguments {
  std::filesystem::path run;
  std::string robot;
  std::string decision;  // "12" or "12..20"
  bool snapshots = false;
  std::filesystem::path svg;  // "-" = standard output, as for the next
  std::filesystem::path json;
};

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

/// Prints one decision or a list on standard output, on standard error if that holds a document.
/// Exit code: 0 done, 1 failed, 2 wrong use.
int RunExplain(const ExplainArguments& arguments) {
  DecisionQuery query{.robot = arguments.robot, .snapshots_only = arguments.snapshots};
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
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(arguments.run, ignored);
  const int code = CheckFiles(kProgram, {{"RUN", is_folder ? "" : arguments.run}},
                              {{"--svg", arguments.svg}, {"--json", arguments.json}});
  if (code != 0) return code;
  return Explain(arguments, query);
}

}  // namespace
}  // namespace conav::planner

// conav-explain: why a robot did what it did.

namespace {

constexpr const char* kAbout =
    R"(Says why a robot did what it did, from the decisions that a run recorded.

RUN is a run folder (./conav demo leaves runs/<time>-seed<S>), or a file decisions.pb.zst.
Without --decision the decisions are listed: robot, number, simulation time, cell, action, its share of
the search's visits, its value, and the margin by which it beats the most visited other action. With
--decision K the situation, all actions of the root with visits, value and the terms of the value,
and the reason in sentences; * marks the action taken.

  goals, steps    reward for goals reached, cost of all other steps
  progress        steps saved on the way to the nearest goal (an addition to the paper)
  guidance        penalty off the operator's path        smoothness      penalty for cells entered again
  information     expected edits of pictures             communication   minus what pictures cost

Values are means over the visits of an action, discounted from the action on; the terms add up.

Exit codes: 0 done; 1 no such robot or decision, or a file has another format or cannot be written; 2 wrong
use, or no such run.

Examples:
  conav explain runs/20261121-172744-seed7                     all decisions
  conav explain runs/20261121-172744-seed7 --pictures          those that sent a picture
  conav explain runs/20261121-172744-seed7 --decision 4 --svg why.svg)";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, "conav explain");
  conav::planner::ExplainArguments arguments;
  app.add_option("run", arguments.run, "The run")->required()->type_name("RUN");
  app.add_option("--robot", arguments.robot, "Only this robot's [all]");
  app.add_option("--decision", arguments.decision, "K: explain this one; A..B: list these");
  app.add_flag("--pictures", arguments.snapshots, "Only those that sent a picture");
  app.add_option("--svg", arguments.svg,
                 "Draw the search tree and the map with the information gain of every picture "
                 "considered; - = standard output (the text then goes to standard error)");
  app.add_option("--json", arguments.json, "Write all figures at full precision, or -");
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return conav::planner::RunExplain(arguments);
}
