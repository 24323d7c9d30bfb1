#include "nhpm/commands/evaluate_command.h"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/runtime/file.h"
#include "common/runtime/json.h"
#include "common/segments/segment_labels.h"
#include "nhpm/commands/evaluate_rows.h"
#include "nhpm/commands/progress_line.h"
#include "nhpm/evaluation/report.h"
#include "nhpm/evaluation/report_json.h"

namespace conav::nhpm {
namespace {

int Failed(const Error& error) {
  fmt::print(stderr, "conav evaluate: {}\n", error.text);
  return 1;
}

void Warn(const std::string& text) { fmt::print(stderr, "conav evaluate: warning: {}\n", text); }

/// Shows the newest of many texts now and then.
class Pace {
 public:
  void operator()(const std::string& text) {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::seconds(1);
    line_.Show(text);
  }

 private:
  ProgressLine line_;
  std::chrono::steady_clock::time_point next_ =
      std::chrono::steady_clock::now() + std::chrono::seconds(1);
};

/// Before the work rather than after it.
Result<void> CheckOutputs(const EvaluateArguments& arguments) {
  for (const auto& path : {arguments.json, arguments.csv, arguments.html}) {
    if (path.empty() || path == "-") continue;
    if (const auto checked = CheckWritable(path); !checked) return checked;
  }
  return {};
}

/// All rows in the order of the table. The baselines come first, as in the paper.
Result<std::vector<ModelRow>> AllRows(const EvaluateArguments& arguments,
                                      const EvaluationData& data) {
  Pace pace;
  const Teller progress = [&pace](const std::string& text) { pace(text); };
  std::vector<ModelRow> rows;
  auto networks = NetworkRows(arguments, data, Warn, progress);
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

/// Exit code 0, or 1 after a message.
int Print(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  return Failed({ErrorCode::kIo, fmt::format("standard output: {}", std::strerror(errno))});
}

int Write(const std::filesystem::path& path, const std::string& text) {
  if (path.empty()) return 0;
  if (path == "-") return Print(text);
  const auto written = WriteFile(path, text);
  return written ? 0 : Failed(written.error());
}

int WriteAll(const EvaluateArguments& arguments, const EvaluationReport& report) {
  const bool to_output = arguments.json == "-" || arguments.csv == "-" || arguments.html == "-";
  const std::string table = ReportTable(report);
  if (to_output) {
    fmt::print(stderr, "{}", table);
  } else if (Print(table) != 0) {
    return 1;
  }
  const int failures = Write(arguments.json, ReportJson(report).dump(2) + "\n") +
                       Write(arguments.csv, ReportCsv(report)) +
                       Write(arguments.html, ReportPage(report));
  return failures == 0 ? 0 : 1;
}

int WrongSegment(std::size_t index, std::size_t count) {
  fmt::print(stderr, "conav evaluate: --segments {}: the test part has segments 0 to {}\n", index,
             count - 1);
  return 2;
}

bool AllPassed(const EvaluationReport& report) {
  for (const Bar& bar : report.bars) {
    if (!bar.passed()) return false;
  }
  return true;
}

}  // namespace

int RunEvaluate(const EvaluateArguments& arguments) {
  if (const auto checked = CheckOutputs(arguments); !checked) return Failed(checked.error());
  auto data = LoadEvaluationData(arguments);
  if (!data) return Failed(data.error());
  const std::size_t count = SegmentCount(data->test);
  for (const std::size_t index : arguments.segments) {
    if (index >= count) return WrongSegment(index, count);
  }
  EvaluationReport report;
  report.data = std::move(*data);
  auto rows = AllRows(arguments, report.data);
  if (!rows) return Failed(rows.error());
  report.rows = std::move(*rows);
  report.bars = CheckBars(report.data, report.rows);
  report.figures = Figures(arguments, report);
  if (const int code = WriteAll(arguments, report); code != 0) return code;
  return arguments.check && !AllPassed(report) ? 1 : 0;
}

}  // namespace conav::nhpm
