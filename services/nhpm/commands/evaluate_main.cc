// conav-evaluate: table 1 of the paper for a segment file.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <set>
#include <string>
#include <thread>

#include "common/console/option_checks.h"
#include "nhpm/commands/evaluate_command.h"

namespace {

using conav::nhpm::EvaluateArguments;

void AddDataFlags(CLI::App& app, EvaluateArguments& arguments) {
  app.add_option("--data", arguments.data, "Segment file, as conav dataset makes it")->required();
  auto* seed = app.add_option("--split-seed", arguments.split_seed,
                              "Which trajectories are for test: the seed given to conav train")
                   ->check(conav::WholeNumber())
                   ->capture_default_str();
  app.add_flag("--all-test", arguments.all_test,
               "Test on the whole file, of which the weights saw nothing; no GLPF-Train row")
      ->excludes(seed);
  app.add_flag("--allow-seen", arguments.allow_seen,
               "Only warn of weights that learned from what they are tested on");
}

void AddModelFlags(CLI::App& app, EvaluateArguments& arguments) {
  app.add_option("--weights", arguments.weights,
                 "Weights file, as conav train makes it; several give a row each (the default "
                 "weights that conav comes with)");
  app.add_option("--without", arguments.without,
                 "One more row for each input named, with the same weights and that input zeroed: "
                 "tau (the path), o (the view), x (the map). For a network that never saw it, give "
                 "--weights of conav train --without")
      ->delimiter(',')
      ->check(CLI::IsMember({"tau", "o", "x"}));
  app.add_option("--oracle-draws", arguments.oracle_draws,
                 "Monte Carlo draws a segment for the oracle's row, on synthetic data; 2000 at "
                 "least, or 0 = no oracle")
      ->capture_default_str()
      ->check(CLI::IsMember({0}) | CLI::Range(2000, 100000000));
  app.add_flag("--average-oracle", arguments.average_oracle,
               "One more row: the mean over synthetic annotators, the best that a model can do "
               "which does not know who looked");
  arguments.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--threads", arguments.threads, "The result is the same on any number")
      ->capture_default_str()
      ->check(CLI::Range(1, 256));
}

void AddOutputFlags(CLI::App& app, EvaluateArguments& arguments) {
  app.add_option("--json", arguments.json,
                 "Write all figures to this file, - = standard output (the table then goes to "
                 "standard error)");
  app.add_option("--csv", arguments.csv, "Write a line per model to this file, or -");
  app.add_option("--html", arguments.html,
                 "Write a page with table, plots and figure 3 to this file, or -");
  app.add_option("--segments", arguments.segments,
                 "Test segments that the page shows, numbers from 0 (those with a misplaced near "
                 "wall, a preferred far wall, and where NHPM and GLPF-Test differ most)")
      ->check(conav::WholeNumber())
      ->delimiter(',');
  app.add_flag("--check", arguments.check,
               "Exit with 1 when a bar is not reached; synthetic data only");
}

/// The message of wrong use that CLI11 does not find; empty = none.
std::string WrongUse(const EvaluateArguments& arguments) {
  int documents = 0;
  for (const auto& path : {arguments.json, arguments.csv, arguments.html}) {
    documents += path == "-" ? 1 : 0;
  }
  if (documents > 1) return "only one of --json, --csv and --html can go to standard output";
  const std::set<std::string> without(arguments.without.begin(), arguments.without.end());
  if (without.size() < arguments.without.size()) return "--without names an input twice";
  if (!arguments.average_oracle) return {};
  if (arguments.oracle_draws == 0) return "--average-oracle needs --oracle-draws";
  if (arguments.all_test) return "--average-oracle is of people of the train part: no --all-test";
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Compares models of how people edit their map, as table 1 of the paper does: the GLPF fitted "
      "to the train part (GLPF-Train) and to the test part itself (GLPF-Test, an upper bound), "
      "NHPM, and on synthetic data the annotators themselves (oracle).\n"
      "Columns: MBCE (mean binary cross-entropy in nats over all outputs, masked ones cost 0; and "
      "over the unmasked ones), IoU of predicted and true edits at the ideal boundary and at 0.5, "
      "ECE (expected calibration error, unmasked outputs), edits expected and made per picture and "
      "their correlation.\n"
      "Exit codes: 0 done; 1 failed, or with --check a bar was not reached; 2 wrong use.",
      "conav evaluate");
  EvaluateArguments arguments;
  AddDataFlags(app, arguments);
  AddModelFlags(app, arguments);
  AddOutputFlags(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (const std::string wrong = WrongUse(arguments); !wrong.empty()) {
    std::fputs(("conav evaluate: " + wrong + "\n").c_str(), stderr);
    return 2;
  }
  return conav::nhpm::RunEvaluate(arguments);
}
