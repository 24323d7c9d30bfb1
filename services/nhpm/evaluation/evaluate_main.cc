#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/segments/segment.h"
#include "nhpm/evaluation/evaluate_rows.h"
#include "nhpm/evaluation/report.h"

namespace conav::nhpm {
namespace {

constexpr const char* kProgram = "conav evaluate";

/// All rows in the order of the table. The baselines come first, as in the paper.
Result<std::vector<ModelRow>> AllRows(const EvaluateArguments& arguments,
                                      const EvaluationData& data) {
  ProgressLine line;
  const Reporter progress = [&line](const std::string& text) { line.ShowNowAndThen(text); };
  const Reporter warn = [](const std::string& text) { Warn(kProgram, text); };
  std::vector<ModelRow> rows;
  auto networks = NetworkRows(arguments, data, warn, progress);
  if (!networks) return networks;
  if (!data.train.trajectories.empty()) {
    auto row = EvaluateGlpfTrain(data);
    if (!row) return tl::unexpected(row.error());
    rows.push_back(std::move(*row));
  }
  auto glpf_test = EvaluateGlpfTest(data);
  if (!glpf_test) return tl::unexpected(glpf_test.error());
  rows.push_back(std::move(*glpf_test));
  std::move(networks->begin(), networks->end(), std::back_inserter(rows));
  auto oracles = OracleRows(arguments, data, progress);
  if (!oracles) return oracles;
  std::move(oracles->begin(), oracles->end(), std::back_inserter(rows));
  return rows;
}

/// The requested segments; by default those with the paper's two cases, and where NHPM and
/// GLPF-Test differ most.
std::vector<FigureSegment> Figures(const EvaluateArguments& arguments,
                                   const EvaluationReport& report) {
  std::vector<FigureSegment> figures;
  for (const std::size_t index : arguments.segments) figures.push_back({index, "by request"});
  if (!figures.empty()) return figures;
  const ModelRow* glpf = FindRow(report.rows, "glpf_test");
  const ModelRow* nhpm = FindRow(report.rows, "nhpm");
  return ChooseFigureSegments(report.data, *glpf, nhpm != nullptr ? *nhpm : report.rows.front());
}

int WriteAll(const EvaluateArguments& arguments, const EvaluationReport& report) {
  const bool to_output = arguments.json == "-" || arguments.csv == "-" || arguments.html == "-";
  const std::string table = ReportTable(report);
  if (to_output) std::fputs(table.c_str(), stderr);
  return ExitCode(kProgram,
                  WriteOutput(to_output ? "" : "-", table)
                      .and_then([&] { return WriteJsonOutput(arguments.json, ReportJson(report)); })
                      .and_then([&] { return WriteOutput(arguments.csv, ReportCsv(report)); })
                      .and_then([&] { return WriteOutput(arguments.html, ReportPage(report)); }));
}

/// What the arguments ask for and the data cannot give; empty = nothing.
std::string WrongUse(const EvaluateArguments& arguments, const EvaluationData& data) {
  const std::size_t count = SegmentCount(data.test);
  for (const std::size_t index : arguments.segments) {
    if (index < count) continue;
    return fmt::format("--segments {}: the test part has segments 0 to {}", index, count - 1);
  }
  if (arguments.average_oracle && !HasOracle(data)) {
    return fmt::format(
        "--average-oracle: the test part of {} is {} data, and only synthetic people have an "
        "oracle",
        data.file, OriginText(data.test));
  }
  if (arguments.check && !HasBars(data)) {
    return fmt::format("--check: the test part of {} is {} data; only synthetic people have bars",
                       data.file, OriginText(data.test));
  }
  return {};
}

int CheckEvaluateFiles(const EvaluateArguments& arguments) {
  std::vector<FileOption> inputs{{"--data", arguments.data}};
  for (const auto& weights : arguments.weights) inputs.push_back({"--weights", weights});
  return CheckFiles(
      kProgram, inputs,
      {{"--json", arguments.json}, {"--csv", arguments.csv}, {"--html", arguments.html}});
}

bool AllPassed(const EvaluationReport& report) {
  for (const Bar& bar : report.bars) {
    if (!bar.passed()) return false;
  }
  return true;
}

}  // namespace

int RunEvaluate(const EvaluateArguments& arguments) {
  if (const int code = CheckEvaluateFiles(arguments); code != 0) return code;
  auto data = LoadEvaluationData(arguments);
  if (!data) return Failed(kProgram, data.error());
  const std::string wrong = WrongUse(arguments, *data);
  if (!wrong.empty()) return Refused(kProgram, wrong);
  EvaluationReport report;
  report.data = std::move(*data);
  auto rows = AllRows(arguments, report.data);
  if (!rows) return Failed(kProgram, rows.error());
  report.rows = std::move(*rows);
  report.bars = CheckBars(report.data, report.rows);
  report.figures = Figures(arguments, report);
  if (const int code = WriteAll(arguments, report); code != 0) return code;
  if (!arguments.check) return 0;
  if (report.bars.empty()) return Refused(kProgram, "--check: needs an NHPM row");
  return AllPassed(report) ? 0 : 1;
}

}  // namespace conav::nhpm

namespace {

using conav::nhpm::EvaluateArguments;

void AddDataFlags(CLI::App& app, EvaluateArguments& arguments) {
  app.add_option("--data", arguments.data, "Segment file of conav dataset")->required();
  auto* seed = app.add_option("--split-seed", arguments.split_seed,
                              "Seed of the split: use the one given to conav train")
                   ->check(conav::WholeNumber())
                   ->capture_default_str();
  app.add_flag("--all-test", arguments.all_test,
               "Test on the whole file, which the weights have never seen; no GLPF-Train row")
      ->excludes(seed);
  app.add_flag("--allow-seen", arguments.allow_seen,
               "Warn instead of failing when the weights learned from the test data");
}

void AddModelFlags(CLI::App& app, EvaluateArguments& arguments) {
  app.add_option(
      "--weights", arguments.weights,
      "Weights file of conav train; several give a row each [the one that comes with conav]");
  app.add_option("--without", arguments.without,
                 "One more row for each input named, with the same weights and that input zeroed: "
                 "tau (the path), o (the view), x (the map). For a network that never saw it, give "
                 "--weights of conav train --without")
      ->delimiter(',')
      ->check(CLI::IsMember({"tau", "o", "x"}));
  app.add_option("--oracle-draws", arguments.oracle_draws,
                 "Monte Carlo draws per segment for the oracle's row, on synthetic data; at least "
                 "2000, or 0 = no oracle")
      ->capture_default_str()
      ->check(CLI::IsMember({0}) | CLI::Range(2000, 100000000));
  app.add_flag("--average-oracle", arguments.average_oracle,
               "One more row: the mean over synthetic annotators, the best possible model that "
               "does not know who looked");
  arguments.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--threads", arguments.threads,
                 "Threads [one per core]; the result is the same on any number")
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
                 "Test segments for the page, numbers from 0 [those with a misplaced near wall, a "
                 "preferred far wall, and the largest differences between NHPM and GLPF-Test]")
      ->check(conav::WholeNumber())
      ->delimiter(',');
  app.add_flag("--check", arguments.check, "Exit with 1 when a bar is missed; synthetic data only");
}

/// Reports wrong usage that CLI11 does not detect; empty = none.
std::string WrongUse(const EvaluateArguments& arguments) {
  int documents = 0;
  for (const auto& path : {arguments.json, arguments.csv, arguments.html}) {
    documents += path == "-" ? 1 : 0;
  }
  if (documents > 1) return "only one of --json, --csv and --html can go to standard output";
  const std::set<std::string> without(arguments.without.begin(), arguments.without.end());
  if (without.size() < arguments.without.size()) return "--without: an input appears twice";
  if (!arguments.average_oracle) return {};
  if (arguments.oracle_draws == 0) return "--average-oracle needs --oracle-draws";
  if (arguments.all_test)
    return "--average-oracle uses people of the train part: it excludes --all-test";
  return {};
}

}  // namespace

// conav-evaluate: table 1 of the paper for a segment file.

int main(int argc, char** argv) {
  CLI::App app(
      "Compares models of how people edit their map, as in table 1 of the paper: the GLPF fitted "
      "to the train part (GLPF-Train) and to the test part itself (GLPF-Test, an upper bound), "
      "NHPM, and on synthetic data the annotators themselves (oracle).\nColumns: MBCE (mean binary "
      "cross-entropy in nats over all outputs, masked ones cost 0; and over the unmasked ones), "
      "IoU of predicted and true edits at the ideal boundary and at 0.5, ECE (expected calibration "
      "error, unmasked outputs), expected and actual edits per picture and their "
      "correlation.\nExit codes: 0 done; 1 failed, or with --check a bar was missed; 2 wrong "
      "usage.",
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
