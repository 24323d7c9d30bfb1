#include "nhpm/commands/evaluate_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/console/console.h"
#include "common/console/progress_line.h"
#include "common/segments/segment_labels.h"
#include "nhpm/commands/evaluate_rows.h"
#include "nhpm/evaluation/report.h"
#include "nhpm/evaluation/report_json.h"

namespace conav::nhpm {
namespace {

constexpr const char* kProgram = "conav evaluate";

/// All rows in the order of the table. The baselines come first, as in the paper.
Result<std::vector<ModelRow>> AllRows(const EvaluateArguments& arguments,
                                      const EvaluationData& data) {
  ProgressLine line;
  const Teller progress = [&line](const std::string& text) { line.ShowNowAndThen(text); };
  const Teller warn = [](const std::string& text) { Warn(kProgram, text); };
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

/// Those that were asked for; else by what they show and where NHPM and GLPF-Test differ.
std::vector<FigureSegment> Figures(const EvaluateArguments& arguments,
                                   const EvaluationReport& report) {
  std::vector<FigureSegment> figures;
  for (const std::size_t index : arguments.segments) figures.push_back({index, "as asked for"});
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

/// What the arguments ask of the data and it cannot give; empty = nothing.
std::string WrongUse(const EvaluateArguments& arguments, const EvaluationData& data) {
  const std::size_t count = SegmentCount(data.test);
  for (const std::size_t index : arguments.segments) {
    if (index < count) continue;
    return fmt::format("--segments {}: the test part has segments 0 to {}", index, count - 1);
  }
  if (arguments.average_oracle && !HasOracle(data)) {
    return fmt::format(
        "--average-oracle: the test part of {} is {} data, of which nobody knows "
        "what would have been done",
        data.file, OriginText(data.test));
  }
  if (arguments.check && !HasBars(data)) {
    return fmt::format(
        "--check: there is nothing to check, as the test part of {} is {} data; bars "
        "are for synthetic people only",
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
  if (report.bars.empty())
    return Refused(kProgram, "--check: without NHPM there is nothing to check");
  return AllPassed(report) ? 0 : 1;
}

}  // namespace conav::nhpm
