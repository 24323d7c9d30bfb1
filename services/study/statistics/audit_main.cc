#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/cli/cli.h"
#include "study/report_page.h"
#include "study/statistics/moments.h"

// conav-audit: what the paper's printed statistics allow to recompute, and whether it agrees.

namespace conav::statistics {
namespace {

constexpr const char* kProgram = "conav audit";
constexpr double kPeople = 14.0;
constexpr double kDf = kPeople - 1.0;

/// Printed with so many decimals: stands for all numbers that round to it.
struct Printed {
  double value = 0.0;
  int decimals = 3;

  double half() const { return 0.5 * std::pow(10.0, -decimals); }
  double low() const { return value - half(); }
  double high() const { return value + half(); }
  std::string text() const { return fmt::format("{:.{}f}", value, decimals); }
  /// Whether some number that `range` allows rounds to it.
  bool Allows(const Interval& range) const { return range.low <= high() && range.high >= low(); }
};

enum class Verdict { kYes, kNo, kOpen };
constexpr const char* kVerdicts[] = {"yes", "NO", "cannot tell"};

struct Finding {
  std::string what;
  std::string printed;
  std::string recomputed;
  Verdict verdict = Verdict::kOpen;
};

Finding Compare(const std::string& what, const Printed& printed, const Interval& range) {
  const double middle = 0.5 * (range.low + range.high);
  return {what, printed.text(), fmt::format("{:.{}f}", middle, printed.decimals + 1),
          printed.Allows(range) ? Verdict::kYes : Verdict::kNo};
}

/// Values of `f`, which falls or rises, over all that `printed` stands for.
template <class Function>
Interval Over(const Printed& printed, Function f) {
  const double a = f(printed.low());
  const double b = f(printed.high());
  return {std::min(a, b), std::max(a, b)};
}

std::string Rounded(const Interval& range) {
  return fmt::format("{:.4g} to {:.4g}", range.low, range.high);
}

struct PrintedAnova {
  const char* measure;
  Printed f, p, eta_squared;
};

constexpr PrintedAnova kAnovas[] = {{"pupil dilation", {6.045}, {0.005}, {0.317}},
                                    {"blink rate", {0.904}, {0.413}, {0.065}},
                                    {"fixation shifts", {3.091}, {0.057}, {0.192}}};

void AuditAnovas(std::vector<Finding>& findings) {
  for (const PrintedAnova& anova : kAnovas) {
    for (const double error_df : {26.0, 39.0}) {
      const std::string what =
          fmt::format("{}: p of F(2, {:g}) = {}{}", anova.measure, error_df, anova.f.text(),
                      error_df == 26.0 ? ", as printed" : ", of independent groups");
      findings.push_back(Compare(
          what, anova.p, Over(anova.f, [&](double f) { return FisherUpper(f, 2.0, error_df); })));
    }
    findings.push_back(Compare(fmt::format("{}: partial eta^2 of F(2, 26)", anova.measure),
                               anova.eta_squared,
                               Over(anova.f, [](double f) { return 2.0 * f / (2.0 * f + 26.0); })));
  }
}

/// Means and SDs of table 2 or 3 for the two conditions, teleoperation or instruction and IG-MCTS.
struct PrintedT {
  const char* what;
  Printed t, d;
  double p;  // printed with three decimals; 0 = "< 0.001"
  double difference, sd_first, sd_second;
  bool of_other_measure = false;  // t and d are printed for steps
};

constexpr PrintedT kTests[] = {
    {"pupil dilation, teleoperation", {2.807}, {0.750}, 0.015, 14.31, 7.66, 7.33},
    {"blink rate, teleoperation", {-3.658}, {-0.978}, 0.003, -3.58, 6.15, 8.54},
    {"fixation shifts, teleoperation", {2.676}, {0.715}, 0.019, 8.27, 12.27, 7.21},
    {"steps, instruction", {46.71, 2}, {12.96, 2}, 0.0, 25.09, 34.99, 118.48},
    {"steps, teleoperation", {9.85, 2}, {2.73, 2}, 0.0, 152.35, 219.01, 118.48},
    {"communication of 13 people with the t of steps, instruction",
     {46.71, 2},
     {12.96, 2},
     0.0,
     82.43,
     6.15,
     0.90,
     true},
    {"communication of 13 people with the t of steps, teleoperation",
     {9.85, 2},
     {2.73, 2},
     0.0,
     104.80,
     38.50,
     0.90,
     true}};

/// |t| from the printed means and SDs: the SD of differences lies between the difference of the SDs
/// and their sum.
Interval BoundsOfT(const PrintedT& test, double people) {
  const double size = std::abs(test.difference) * std::sqrt(people);
  return {size / (test.sd_first + test.sd_second), size / std::abs(test.sd_first - test.sd_second)};
}

void AuditTests(std::vector<Finding>& findings) {
  for (const PrintedT& test : kTests) {
    const std::string what = test.what;
    if (test.p > 0.0) {
      findings.push_back(Compare(what + ": p of t(13)", {test.p},
                                 Over(test.t, [](double t) { return StudentTwoSided(t, kDf); })));
    }
    const bool is_table_3 = test.p == 0.0;
    for (const double people : {kPeople, kPeople - 1.0}) {
      if (test.of_other_measure || (people < kPeople && !is_table_3)) continue;
      findings.push_back(Compare(fmt::format("{}: d = t / sqrt({:g})", what, people), test.d,
                                 Over(test.t, [&](double t) { return t / std::sqrt(people); })));
    }
    const Interval bounds = BoundsOfT(test, test.of_other_measure ? kPeople - 1.0 : kPeople);
    const double size = std::abs(test.t.value);
    const bool inside = size >= bounds.low && size <= bounds.high;
    // Table 2's SDs of pupil dilation are over time (appendix D.1), not over people.
    const bool is_open = what.starts_with("pupil");
    findings.push_back({what + ": size of t that means and SDs allow", test.t.text(),
                        Rounded(bounds),
                        is_open  ? Verdict::kOpen
                        : inside ? Verdict::kYes
                                 : Verdict::kNo});
  }
}

void AuditTable3(std::vector<Finding>& findings) {
  struct Row {
    const char* what;
    Printed steps, mb;
  };
  for (const Row& row : {Row{"teleoperation, mean", {609.71, 2}, {107.18, 2}},
                         Row{"teleoperation, SD", {219.01, 2}, {38.50, 2}},
                         Row{"instruction, mean", {482.45, 2}, {84.81, 2}},
                         Row{"instruction, SD", {34.99, 2}, {6.15, 2}}}) {
    findings.push_back(Compare(fmt::format("{}: MB = steps x 180 / 1024", row.what), row.mb,
                               Over(row.steps, [](double s) { return s * 180.0 / 1024.0; })));
  }
  findings.push_back({"IG-MCTS: pictures of 180 / 1024 MB in 2.38 MB (0.90)", "-",
                      fmt::format("{:.1f} ({:.1f})", 2.38 * 1024 / 180, 0.90 * 1024 / 180),
                      Verdict::kOpen});
  findings.push_back({"communication saved against instruction, over 0.97", "0.97",
                      fmt::format("{:.4f}", 1.0 - 2.38 / 84.81), Verdict::kYes});
  for (const double episodes : {kPeople, 2.0 * kPeople, 3.0 * kPeople}) {
    const Printed mean{482.45, 2};
    const double nearest = std::round(mean.value * episodes) / episodes;
    findings.push_back(
        Compare(fmt::format("instruction: mean steps of {:g} episodes of whole steps", episodes),
                mean, {nearest, nearest}));
  }
}

/// "Comparable" steps: the narrowest interval of the ratio that the printed SDs allow.
Finding AuditComparable() {
  const double error = (118.48 - 34.99) / std::sqrt(kPeople);
  const Interval difference = StudentInterval(457.36 - 482.45, error, kDf, 0.1);
  const Interval ratio{1.0 + difference.low / 482.45, 1.0 + difference.high / 482.45};
  return {"steps comparable within 5 %: 90 % interval of the ratio, at its narrowest", "not tested",
          Rounded(ratio), ratio.low >= 0.95 && ratio.high <= 1.05 ? Verdict::kYes : Verdict::kNo};
}

std::vector<Finding> AuditPaper() {
  std::vector<Finding> findings;
  AuditAnovas(findings);
  AuditTests(findings);
  AuditTable3(findings);
  findings.push_back(AuditComparable());
  for (const char* what : {"sphericity, Greenhouse-Geisser and Holm corrections",
                           "tests of communication, and of instruction against teleoperation",
                           "pupil dilation per person; figures 4 to 6; table 1 (MBCE, IoU)",
                           "order of conditions and layouts, the participant who is missing"}) {
    findings.push_back({what, "not printed", "-", Verdict::kOpen});
  }
  return findings;
}

nlohmann::ordered_json ToJson(const std::vector<Finding>& findings) {
  nlohmann::ordered_json json{{"schema", 1}, {"findings", nlohmann::ordered_json::array()}};
  int counts[] = {0, 0, 0};
  for (const Finding& finding : findings) {
    const auto verdict = static_cast<std::size_t>(finding.verdict);
    ++counts[verdict];
    json["findings"].push_back({{"what", finding.what},
                                {"printed", finding.printed},
                                {"recomputed", finding.recomputed},
                                {"consistent", kVerdicts[verdict]}});
  }
  json["consistent"] = counts[0];
  json["inconsistent"] = counts[1];
  json["open"] = counts[2];
  return json;
}

std::string Text(const std::vector<Finding>& findings) {
  study::ReportSection section{
      .title = "Printed statistics of the paper (section 6.2), recomputed from what it prints",
      .header = {"what", "printed", "recomputed", "consistent"}};
  for (const Finding& finding : findings) {
    section.rows.push_back({finding.what, finding.printed, finding.recomputed,
                            kVerdicts[static_cast<std::size_t>(finding.verdict)]});
  }
  return study::SectionsText({&section, 1});
}

constexpr const char* kAbout =
    R"(Recomputes what the paper's printed statistics allow: p and eta^2 of its F, p and d of its t, the t that
its means and standard deviations allow, megabytes of its steps, and whether "comparable" could be
shown; and lists what cannot be recomputed. A printed number stands for all that round to it.
docs/paper.md says what follows.

Exit codes: 0 done, whatever is found; 1 writing failed; 2 wrong usage.)";

}  // namespace
}  // namespace conav::statistics

int main(int argc, char** argv) {
  using namespace conav;
  CLI::App app("Recomputes what a paper prints.", "conav audit");
  app.require_subcommand(1);
  std::filesystem::path json;
  app.add_subcommand("paper", statistics::kAbout)
      ->add_option("--json", json,
                   "Write the findings to this file; - = standard output (the table then goes to "
                   "standard error)");
  if (const auto ended = Parse(app, argc, argv)) return *ended;
  if (const int code = CheckFiles(statistics::kProgram, {}, {{"--json", json}}); code != 0) {
    return code;
  }
  const auto findings = statistics::AuditPaper();
  const std::string table = statistics::Text(findings);
  if (json == "-") fmt::print(stderr, "{}", table);
  return ExitCode(statistics::kProgram, WriteOutput(json == "-" ? "" : "-", table).and_then([&] {
    return WriteJsonOutput(json, statistics::ToJson(findings));
  }));
}
