#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/plot/axes.h"
#include "nhpm/evaluation/matrix.h"
#include "nhpm/evaluation/report.h"

namespace conav::nhpm {
namespace {

using Json = nlohmann::ordered_json;

std::string NumberText(const Json& object, const std::string& key, double factor, int digits) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return "-";
  return fmt::format("{:.{}f}", factor * found->get<double>(), digits);
}

/// A row for each kind learned from, a column for each kind tested on.
std::string Block(const Json& matrix, const std::string& title, const std::string& key,
                  double factor, int digits) {
  std::string text = fmt::format("\n{}\n{:<12}", title, "");
  for (const auto& [test, cell] : matrix.begin()->items()) text += fmt::format("{:>10}", test);
  for (const auto& [train, row] : matrix.items()) {
    text += fmt::format("\n{:<12}", train);
    for (const auto& [test, cell] : row.items()) {
      text += fmt::format("{:>10}", NumberText(cell, key, factor, digits));
    }
    if (key.starts_with("glpf_test") || key.starts_with("oracle")) break;  // all rows are alike
  }
  return text + "\n";
}

/// A row for each kind, a column for each key.
std::string Rows(const Json& kinds, const std::string& title, const std::vector<std::string>& keys,
                 double factor) {
  std::string text = fmt::format("\n{}\n{:<12}", title, "");
  for (const std::string& key : keys) text += fmt::format("{:>12}", key);
  for (const auto& [kind, row] : kinds.items()) {
    text += fmt::format("\n{:<12}", kind);
    for (const std::string& key : keys) {
      text += fmt::format(
          "{:>12}", NumberText(row, key, key == "people" ? 1.0 : factor, key == "people" ? 0 : 1));
    }
  }
  return text + "\n";
}

Calibration CalibrationOf(const Json& cell) {
  Calibration calibration{cell.at("nhpm_ece"), {}};
  for (const Json& bin : cell.at("nhpm_reliability")) {
    calibration.bins.push_back({bin.at("low"), bin.at("high"), bin.at("outputs"),
                                bin.at("mean_probability"), bin.at("edited_share")});
  }
  return calibration;
}

/// MBCE over the trajectories learned from: NHPM a line, the GLPF a dashed one.
std::string CurvePlot(const std::string& kind, const Json& curve) {
  double most = 0.0;
  std::vector<double> counts;
  for (const auto& [count, cell] : curve.items()) {
    counts.push_back(std::stod(count));
    for (const char* key : {"nhpm_mbce", "glpf_mbce"}) {
      most = std::max(most, cell.at(key).get<double>());
    }
  }
  const auto [least_count, most_count] = std::ranges::minmax(counts);
  SvgCanvas canvas;
  const PlotArea area{
      {52.0, 12.0},
      200.0,
      200.0,
      {.low = least_count / 1.1, .high = most_count * 1.1, .scale = Scale::kLogarithmic},
      RoundAxis(0.0, 1000.0 * most, 4)};
  area.Draw(canvas, "trajectories", "MBCE x 1000");
  for (const auto& [key, style] :
       {std::pair("nhpm_mbce", "class=\"curve\""), std::pair("glpf_mbce", "class=\"ideal\"")}) {
    std::vector<PixelPosition> line;
    for (const auto& [count, cell] : curve.items()) {
      line.push_back(area.At(std::stod(count), 1000.0 * cell.at(key).get<double>()));
    }
    canvas.Polyline(line, style);
  }
  return canvas.Inline(270.0, 260.0, "Learning curve on " + kind);
}

std::string Figure(const std::string& drawing, const std::string& caption) {
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", drawing,
                     EscapeXml(caption));
}

/// For a terminal.
std::string MatrixTable(const Json& json) {
  const Json& matrix = json.at("matrix");
  std::string text = fmt::format(
      "Rows: the people learned from ({} trajectories of each population); columns: the people "
      "tested on. MBCE x 100,000.\n",
      json.at("settings").at("trajectories").get<int>());
  constexpr double kScale = 1e5;
  text += Block(matrix, "NHPM, MBCE", "nhpm_mbce", kScale, 1);
  text += Block(matrix, "GLPF-Train, MBCE", "glpf_mbce", kScale, 1);
  text += Block(matrix, "Both, pooled half and half (--model auto at first), MBCE", "pool_mbce",
                kScale, 1);
  text += Block(matrix, "GLPF-Test, MBCE", "glpf_test_mbce", kScale, 1);
  text += Block(matrix, "Oracle, MBCE", "oracle_mbce", kScale, 1);
  text += Block(matrix, "NHPM, IoU", "nhpm_iou", 1.0, 3);
  text += Block(matrix, "GLPF-Train, IoU", "glpf_iou", 1.0, 3);
  if (json.contains("curve")) {
    for (const auto& [kind, curve] : json.at("curve").items()) {
      text += Rows(curve, "Learning curve, trajectories of " + kind,
                   {"nhpm_mbce", "glpf_mbce", "oracle_mbce"}, kScale);
    }
  }
  if (json.contains("adaptation")) {
    text += Rows(
        json.at("adaptation"),
        "Weights of the others after 0, 5, 20, 100 segments of one person, the GLPF alike, and "
        "both pooled, whose weights alone learn",
        {"0", "5", "20", "100", "glpf", "glpf_5", "glpf_20", "glpf_100", "pool_0", "pool_5",
         "pool_20", "pool_100", "people"},
        kScale);
  }
  if (!json.contains("bars")) return text;
  for (const auto& [name, bar] : json.at("bars").items()) {
    text += fmt::format("\n{}  {}: {} of {} kinds (must be at least {})",
                        bar.at("passed").get<bool>() ? "pass" : "FAIL", name,
                        bar.at("value").get<int>(), bar.at("kinds").get<int>(),
                        bar.at("limit").get<int>());
  }
  return text + "\n";
}

/// These tables, learning curves, and reliability diagrams of the weights that never learned from the
/// kind tested on, or else of the first ones.
std::string MatrixPage(const Json& json, const std::string& table) {
  std::string html =
      PageHead("Models of how people edit, on strangers") + "<pre>" + EscapeXml(table) + "</pre>\n";
  if (json.contains("curve")) {
    html += "<h2>Learning curves: NHPM, and GLPF-Train dashed</h2>\n<div class=\"row\">\n";
    for (const auto& [kind, curve] : json.at("curve").items()) {
      html += Figure(CurvePlot(kind, curve), kind);
    }
    html += "</div>\n";
  }
  const Json& matrix = json.at("matrix");
  const std::string train = matrix.contains("others") ? "others" : matrix.begin().key();
  html += "<h2>Reliability of NHPM that learned from: " + EscapeXml(train) +
          "</h2>\n<div class=\"row\">\n";
  for (const auto& [test, cell] : matrix.at(train).items()) {
    html += Figure(ReliabilityPlot(test, CalibrationOf(cell)), test);
  }
  return html + "</div>\n</body>\n</html>\n";
}

}  // namespace

int RunMatrix(const MatrixArguments& arguments, const StopToken& stop) {
  if (arguments.train_on.empty() || arguments.test_on.empty()) {
    return Refused(kProgram, "--train-on and --test-on need each other");
  }
  const bool has_bars = std::ranges::count(arguments.train_on, kOthers) > 0 || arguments.people > 0;
  if (arguments.check && !has_bars) return Refused(kProgram, "--check: needs others, or --people");
  std::vector<FileOption> inputs;
  for (const std::string& file : arguments.test_on) inputs.push_back({"--test-on", file});
  for (const std::string& file : arguments.train_on) {
    if (file != kOthers) inputs.push_back({"--train-on", file});
  }
  const int code =
      CheckFiles(kProgram, inputs, {{"--json", arguments.json}, {"--html", arguments.html}});
  if (code != 0) return code;
  const auto json = ComputeMatrix(arguments, stop);
  if (!json) return Failed(kProgram, json.error());
  const std::string table = MatrixTable(*json);
  const int written = ExitCode(
      kProgram,
      WriteOutput(arguments.json == "-" ? "" : "-", table)
          .and_then([&] { return WriteJsonOutput(arguments.json, *json); })
          .and_then([&] { return WriteOutput(arguments.html, MatrixPage(*json, table)); }));
  if (written != 0 || !arguments.check) return written;
  if (!json->contains("bars")) return 1;  // nobody has enough segments
  const Json& bars = json->at("bars");
  return std::ranges::all_of(bars, [](const Json& bar) { return bar.at("passed").get<bool>(); })
             ? 0
             : 1;
}

void AddMatrixFlags(CLI::App& app, MatrixArguments& arguments) {
  app.add_option(
         "--train-on", arguments.train_on,
         "With --test-on: compares models on strangers. Kinds of people to learn from: "
         "populations (YAML, as for conav dataset synthesize) or segment files; others = all "
         "kinds of --test-on but the one tested on")
      ->delimiter(',');
  app.add_option("--test-on", arguments.test_on, "Kinds of people to test on")->delimiter(',');
  AddNumber(app, "--trajectories", arguments.trajectories,
            "With --train-on: to learn from, of each population", 4, 100000);
  AddNumber(app, "--test-trajectories", arguments.test_trajectories,
            "With --train-on: to test on, of each population, each of another person", 2, 100000);
  app.add_option("--curve", arguments.curve,
                 "With --train-on: learning curves over these numbers of trajectories")
      ->delimiter(',')
      ->check(Between(4, 100000));
  AddNumber(app, "--people", arguments.people,
            "With --train-on: adapts the weights of the other kinds to so many people of each "
            "kind, with 5, 20 and 100 of their segments",
            0, 1000);
  app.add_option("--view-encoding", arguments.view_encoding, "With --train-on: as for conav train")
      ->capture_default_str()
      ->check(CLI::IsMember({"mask", "depth"}));
  app.add_option("--width", arguments.training.width, "With --train-on: as for conav train")
      ->capture_default_str()
      ->check(CLI::IsMember({16, 32, 64}));
  AddNumber(app, "--epochs", arguments.training.epochs, "With --train-on: as for conav train", 1,
            1000000);
  AddSeed(app, "--seed", arguments.seed, "With --train-on: of the populations");
  app.add_option("--cache", arguments.cache,
                 "With --train-on: folder of what is done, so that the same command continues")
      ->capture_default_str();
}

}  // namespace conav::nhpm
