#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "study/live_report.h"

// conav-study-report: tables, tests and a page of a study with people.

namespace conav::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "conav study report";

constexpr const char* kAbout =
    R"(Tables, tests and plots of a study with people: DIR is the folder of conav study --live, with one
folder for each participant. Prints the tables and writes

  report.html    one page: who took part and who is left out, table 3 of the paper, repeated-measures ANOVA
                 with Greenhouse-Geisser, paired t tests with Holm's p and d_z, Friedman, questionnaires, eye
                 measures (table 2 and figure 4), order effects, demographics, attention checks, deviations,
                 a plot for each measure; each table links to the files of its figures
  trials.csv     one line per trial with all measures, scores and answers
  codebook.csv   what each of its columns is: meaning, unit, range, source, and when it is empty
  measures/      participant x method (and x position) of each measure, for conav stats

Participants count once their protocol is complete. Those who have not finished or were aborted are listed
with the reason, stay in trials.csv (included: no), and are in no table or test. A file that cannot be read
is named; its participant is left out, the report is written, and the exit code is 1.

With --power it simulates how many participants a study like this pilot needs. Details: docs/study-report.md.)";

constexpr const char* kExamples =
    R"(Examples:
  conav study report runs/study-methods
  conav study report runs/study-methods --participants P01,P02,P05 --out without-p03
  conav study report runs/study-pilot --power low_level_steps,tlx

Exit codes: 0 done; 1 a file of the study is malformed, or writing failed; 2 wrong usage, or no such study.)";

struct ReportArguments {
  fs::path study;
  fs::path out;  // empty = the study's folder
  fs::path json;
  std::vector<std::string> participants;
  std::vector<std::string> power;
};

Result<void> WriteAll(const ReportArguments& arguments, const LiveReport& report) {
  std::error_code error;
  fs::create_directories(arguments.out / "measures", error);
  if (error) {
    return Fail(ErrorCode::kIo, fmt::format("{}: cannot create this folder: {}",
                                            arguments.out.string(), error.message()));
  }
  for (const auto& [name, text] : LiveFiles(report)) {
    if (auto written = WriteFile(arguments.out / name, text); !written) return written;
  }
  const std::string text =
      fmt::format("{}\n{} holds report.html, trials.csv, codebook.csv and measures/\n",
                  LiveText(report), fs::absolute(arguments.out).lexically_normal().string());
  if (arguments.json == "-") {
    fmt::print(stderr, "{}", text);
  } else if (auto printed = WriteStandardOutput(text); !printed) {
    return printed;
  }
  return WriteJsonOutput(arguments.json, LiveJson(report));
}

int Run(ReportArguments arguments, Provenance provenance) {
  if (arguments.out.empty()) arguments.out = arguments.study;
  const int code = CheckFiles(kProgram, {}, {{"--json", arguments.json}});
  if (code != 0) return code;
  auto study = ReadLiveStudy(arguments.study, arguments.participants);
  if (!study && study.error().code == ErrorCode::kNotFound) {
    return Refused(kProgram, study.error().text);
  }
  if (!study) return Failed(kProgram, study.error());
  for (const std::string& problem : study->problems) Warn(kProgram, problem);
  auto report =
      MakeLiveReport(*std::move(study), arguments.out, arguments.power, std::move(provenance));
  if (!report) return Refused(kProgram, report.error().text);
  if (auto written = WriteAll(arguments, *report); !written) {
    return Failed(kProgram, written.error());
  }
  return report->study.problems.empty() ? 0 : 1;
}

}  // namespace
}  // namespace conav::study

int main(int argc, char** argv) {
  CLI::App app(conav::study::kAbout, conav::study::kProgram);
  conav::study::ReportArguments arguments;
  app.add_option("study", arguments.study, "The study's folder")->required()->type_name("DIR");
  app.add_option("--out", arguments.out, "Folder for the files [DIR]");
  app.add_option("--json", arguments.json,
                 "Write the numbers to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.add_option("--participants", arguments.participants,
                 "Only these participants count [all who are complete]")
      ->delimiter(',');
  app.add_option(
         "--power", arguments.power,
         "Take the study as a pilot: simulate for these measures (columns of trials.csv, or "
         "all) how many participants show each pair and the ANOVA with power 0.8 and 0.9")
      ->delimiter(',')
      ->type_name("MEASURE");
  app.footer(conav::study::kExamples);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  try {
    return conav::study::Run(std::move(arguments),
                             conav::study::DescribeRun(conav::study::kProgram, argc, argv));
  } catch (const std::exception& error) {  // of files whose values have other types
    return conav::Failed(conav::study::kProgram, {conav::ErrorCode::kMalformed, error.what()});
  }
}
