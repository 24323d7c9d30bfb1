// conav-explain: why a robot did what it did.
#include <CLI/CLI.hpp>

#include "planner/explain/explain_command.h"

namespace {

constexpr const char* kAbout =
    R"(Says why a robot did what it did, from the decisions that a run recorded.

RUN is a run folder (./conav demo leaves runs/<time>-seed<S>), or a file decisions.pb.zst.
Without --decision the decisions are listed: robot, number, simulation time, cell, action, its share of
the search's visits, its value, and the margin by which it beats the most visited other action. With
--decision K the situation, all actions of the root with visits, value and what the value is made of,
and in sentences why; * marks the action taken.

  goals, steps    reward for goals reached, cost of all other steps
  progress        steps saved on the way to the nearest goal (an addition to the paper)
  guidance        penalty off the operator's path        smoothness      penalty for cells entered again
  information     expected edits of pictures             communication   minus what pictures cost

Values are means over the visits of an action, discounted from the action on; the terms add up.

Exit codes: 0 done; 1 no such run, robot or decision, or a file cannot be read or written; 2 wrong use.

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
  app.add_flag("--pictures", arguments.pictures, "Only those that sent a picture");
  app.add_option("--svg", arguments.svg,
                 "Draw the search tree and the map with the information gain of every picture that "
                 "was thought of; - = standard output (the text then goes to standard error)");
  app.add_option("--json", arguments.json, "Write all figures at full precision, or -");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return conav::planner::RunExplain(arguments);
}
