#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "study/statistics/report.h"

namespace conav::statistics {
namespace {

/// The arguments of `conav stats`; empty paths = off.
struct StatsArguments {
  std::filesystem::path data;
  std::filesystem::path json;  // "-" = standard output, as for the next
  std::filesystem::path html;
  double alpha = 0.05;  // in (0, 1)
  std::optional<double> margin;
};

constexpr const char* kProgram = "conav stats";

Result<Analysis> AnalyseFile(const StatsArguments& arguments) {
  const auto bytes = ReadFile(arguments.data);
  if (!bytes) return tl::unexpected(bytes.error());
  auto analysis = AnalyseText(*bytes, arguments.data.string(), arguments.alpha);
  if (analysis && arguments.margin) AddEquivalence(*analysis, *arguments.margin, true);
  return analysis;
}

Result<void> WriteAll(const StatsArguments& arguments, const Analysis& analysis) {
  const std::string tables = ReportText(analysis);
  if (arguments.json == "-" || arguments.html == "-") {
    fmt::print(stderr, "{}", tables);
  } else if (auto printed = WriteStandardOutput(tables); !printed) {
    return printed;
  }
  if (auto written = WriteJsonOutput(arguments.json, ReportJson(analysis)); !written) {
    return written;
  }
  return WriteOutput(arguments.html, ReportPage(analysis));
}

/// Prints the tables on standard output, or on standard error if standard output holds a document.
/// Exit code: 0 done, 1 failed, 2 wrong usage.
int RunStats(const StatsArguments& arguments) {
  if (arguments.json == "-" && arguments.html == "-") {
    return Refused(kProgram, "only one of --json and --html can go to standard output");
  }
  const int code = CheckFiles(kProgram, {{"FILE", arguments.data}},
                              {{"--json", arguments.json}, {"--html", arguments.html}});
  if (code != 0) return code;
  const auto analysis = AnalyseFile(arguments);
  if (!analysis) return Failed(kProgram, analysis.error());
  return ExitCode(kProgram, WriteAll(arguments, *analysis));
}

}  // namespace
}  // namespace conav::statistics

namespace {

constexpr const char* kAbout =
    R"(Compares conditions that the same subjects went through: one value per subject and condition.

FILE is a CSV file, decimals with a point:
  subject,teleoperation,instruction,ig-mcts
  p01,107.2,84.8,2.4
  ...
All results leave out, and name, a subject with an empty cell (or NA).

Output:
  Conditions   n, mean, SD (n - 1), median, confidence interval (CI) of the mean; CI within subjects
               (Cousineau-Morey): for comparing conditions, without the subjects' own levels
  Analysis of variance for repeated measures: F, with its degrees of freedom and with these times the
               epsilon of Greenhouse-Geisser and of Huynh-Feldt (at most 1), needed where sphericity
               (Mauchly's test) does not hold; partial eta^2 (conditions / conditions + error) and
               generalised eta^2 (the subjects' differences in the denominator too)
  Paired t     for every pair: mean difference with CI, t, p, and p adjusted for the number of pairs
               by Holm, Bonferroni, and Benjamini-Hochberg (BH, false discovery rate); d_z (mean / SD
               of the differences), d_av (in units of the conditions' average SD), g_z (d_z corrected
               for few subjects)
  Friedman     the same question by ranks alone: chi^2, p, Kendall's W (1 = all rankings agree)
  Wilcoxon     signed ranks for every pair, p exact or from the normal distribution; and
               Shapiro-Wilk: are the differences normal, as the t test assumes
  Equivalence  with --equivalence, for every pair: is the ratio of the means (first / second) within
               1 -+ MARGIN, by two one-sided paired t tests (TOST) with Fieller's interval; and the
               number of subjects with which a simulation at the observed spread shows it in 80 % of
               studies when the means are equal
'-' marks a figure that these data do not have; a note gives the reason. Details: docs/statistics.md.

Exit codes: 0 done; 1 the file has another format, or writing failed; 2 wrong usage, or no such
file.)";

}  // namespace

// conav-stats: statistics of a table with one value per subject and condition.

int main(int argc, char** argv) {
  CLI::App app(kAbout, "conav stats");
  conav::statistics::StatsArguments arguments;
  app.add_option("file", arguments.data, "The table")->required()->type_name("FILE");
  app.add_option("--json", arguments.json,
                 "Write all figures at full precision to this file; - = standard output (the "
                 "tables then go to standard error)");
  app.add_option("--html", arguments.html,
                 "Write a page with the tables and a plot to this file, or -");
  app.add_option("--alpha", arguments.alpha, "Confidence intervals hold with 1 - alpha")
      ->capture_default_str()
      ->check(conav::Between(1e-6, 0.5));
  app.add_option(
         "--equivalence", arguments.margin,
         "Test every pair for equivalence: margin as a share of the second mean, 0.05 = 5 %")
      ->type_name("MARGIN")
      ->check(conav::Between(0.001, 0.5));
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return conav::statistics::RunStats(arguments);
}
