// conav-evaluate: table 1 of the paper for a segment file.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "common/cli/cli.h"
#include "common/cli/progress_line.h"
#include "common/segments/segment_split.h"
#include "nhpm/dataset/synthesize.h"
#include "nhpm/evaluation/canvas_evaluation.h"
#include "nhpm/evaluation/matrix.h"
#include "nhpm/evaluation/report.h"
#include "nhpm/model/encoder_decoder_model.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/perception_network.h"

namespace conav::nhpm {
namespace {

/// The arguments of `conav evaluate`; empty paths = off.
struct EvaluateArguments {
  std::filesystem::path data;
  std::vector<std::filesystem::path> weights;  // none = the shipped ones, if any
  std::filesystem::path encoder_decoder;       // its weights: compares on the canvas
  std::vector<std::string> without;            // "tau", "o", "x": one more row for each
  std::uint64_t split_seed = kDefaultSplitSeed;
  bool all_test = false;  // no split: the weights never saw this file
  bool allow_seen = false;
  int oracle_draws = 20000;  // a segment; 0 = no oracle
  bool average_oracle = false;
  int threads = 1;
  std::vector<std::size_t> segments;  // for the page; none = chosen by content
  std::filesystem::path json;         // "-" = standard output, for the next two as well
  std::filesystem::path csv;
  std::filesystem::path html;
  bool check = false;  // a missed bar is a failure; no bar at all is wrong usage
};

/// Receives progress and warnings: "NHPM: 64 of 85 segments".
using Reporter = std::function<void(const std::string& text)>;

std::string Value(const NetworkModel& model, const char* name) {
  const auto found = model.training.find(name);
  return found == model.training.end() ? "" : found->second;
}

/// What to do about weights that learned from the test part.
std::string Remedy(const NetworkModel& model, const EvaluationData& data) {
  const bool adapted = !Value(model, "adapt_data_sha256").empty();
  if (!adapted && Value(model, "data_sha256") == data.checksum) {
    return "pass --split-seed " + Value(model, "split_seed");
  }
  return "pass data that it never saw (for synthetic people, use another --seed)";
}

/// A network and the name of its row.
struct NamedNetwork {
  RowLabel label;
  NetworkModel model;
};

NamedNetwork Named(const NetworkModel& model, const std::filesystem::path& file,
                   std::size_t number) {
  const std::string suffix = number == 0 ? "" : fmt::format("_{}", number + 1);
  const std::string missing = MissingInputs(model.inputs);
  RowLabel label;
  label.key = fmt::format("nhpm{}", suffix);
  label.title = number == 0 ? "NHPM" : fmt::format("NHPM {}", number + 1);
  label.about = fmt::format("{}: {}; trained on {} data{}", file.filename().string(), model.version,
                            model.data_origin, missing.empty() ? "" : ", without " + missing);
  return {label, model};
}

NamedNetwork Without(const NamedNetwork& whole, const std::string& input) {
  NamedNetwork ablated = whole;
  InputOf(ablated.model.inputs, input) = false;
  ablated.label.key = fmt::format("{}_without_{}", whole.label.key, input);
  ablated.label.title = fmt::format("{} without {}", whole.label.title, input);
  ablated.label.about = fmt::format("the same weights, with input {} zeroed", input);
  return ablated;
}

/// The named files, or the shipped one if it exists.
std::vector<std::filesystem::path> Files(const EvaluateArguments& arguments, const Reporter& warn) {
  if (!arguments.weights.empty()) return arguments.weights;
  const std::filesystem::path shipped = ShippedWeights();
  if (std::filesystem::exists(shipped)) return {shipped};
  warn(fmt::format("no --weights given and none at {}: no NHPM row", shipped.string()));
  return {};
}

Result<ModelRow> RowOf(const NamedNetwork& network, const EvaluationData& data,
                       const Reporter& progress) {
  PerceptionNetwork model(network.model);
  return EvaluateModel(network.label, model, data, [&](std::size_t done, std::size_t total) {
    progress(fmt::format("{}: {} of {} test segments", network.label.title, done, total));
  });
}

constexpr std::size_t kAveragePeople = 100;  // limit for the mean over people

bool IsSynthetic(const Trajectory& trajectory) {
  return trajectory.origin == SegmentOrigin::kSynthetic;
}

OracleOptions OptionsOf(const EvaluateArguments& arguments, const Reporter& progress,
                        const char* what) {
  return {.draws = arguments.oracle_draws,
          .threads = arguments.threads,
          .progress = [&progress, what](std::size_t done, std::size_t total) {
            progress(fmt::format("{} {} of {}", what, done, total));
          }};
}

Result<ModelRow> OracleRow(const EvaluateArguments& arguments, const EvaluationData& data,
                           const Reporter& progress) {
  auto by_trajectory =
      OracleAnswers(data.test.trajectories, OptionsOf(arguments, progress, "oracle: trajectory"));
  if (!by_trajectory) {
    return Fail(by_trajectory.error().code,
                fmt::format("{}: test part: {}", data.file, by_trajectory.error().text));
  }
  std::vector<PerceptionAnswer> answers;
  for (auto& some : *by_trajectory) std::ranges::move(some, std::back_inserter(answers));
  return EvaluateAnswers(
      {"oracle", "Oracle",
       fmt::format("the synthetic annotators themselves, {} draws per segment: the best possible "
                   "on average, up to the filter of their trajectories",
                   arguments.oracle_draws)},
      {"oracle", fmt::format("{} draws", arguments.oracle_draws), ""}, std::move(answers), data);
}

/// Some of the synthetic people who edited the train part, evenly spread over it.
Result<std::vector<operators::SnapshotReaderParameters>> People(const EvaluationData& data) {
  std::vector<std::size_t> synthetic;
  for (std::size_t i = 0; i < data.train.trajectories.size(); ++i) {
    if (IsSynthetic(data.train.trajectories[i])) synthetic.push_back(i);
  }
  if (synthetic.empty()) {
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{}: no synthetic people in the train part", data.file));
  }
  const std::size_t count = std::min(synthetic.size(), kAveragePeople);
  std::vector<operators::SnapshotReaderParameters> people;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t index = synthetic[i * synthetic.size() / count];
    const Trajectory& trajectory = data.train.trajectories[index];
    const auto person = FromNamedValues(trajectory.annotator);
    if (!person) {
      return Fail(person.error().code,
                  fmt::format("{}: train part: trajectory {} ({}): {}", data.file, index,
                              trajectory.session, person.error().text));
    }
    people.push_back(*person);
  }
  return people;
}

Result<ModelRow> AverageRow(const EvaluateArguments& arguments, const EvaluationData& data,
                            const Reporter& progress) {
  const auto people = People(data);
  if (!people) return tl::unexpected(people.error());
  return EvaluateAnswers(
      {"oracle_average", "Oracle, average",
       fmt::format("mean over {} synthetic annotators: knows how people edit, not who looked",
                   people->size())},
      {"oracle_average", fmt::format("{} people", people->size()), ""},
      AverageOracleAnswers(*people, Queries(data.test),
                           OptionsOf(arguments, progress, "average of people: segment")),
      data);
}

/// Checks that `model` never learned from a trajectory of the test part, in any file. Returns a
/// warning if that is unknown or allowed, else an empty text.
/// Errors: kRefused if it did; `name` is the weights file.
Result<std::string> CheckUnseen(const NetworkModel& model, const std::filesystem::path& name,
                                const EvaluationData& data, bool allow_seen) {
  if (model.learned_from.empty()) return UnknownLearning(name);
  const std::size_t seen = CountKnown(data.test, model.learned_from);
  if (seen == 0) return std::string();
  const std::string problem = fmt::format("{}: learned from {} of the {} test trajectories",
                                          name.string(), seen, data.test.trajectories.size());
  if (allow_seen) return problem;
  return Fail(ErrorCode::kRefused,
              fmt::format("{}; {}, or --allow-seen", problem, Remedy(model, data)));
}

/// The network of a weights file that did not learn from the test part. Errors: those of
/// ReadWeightsFile and CheckUnseen; kInvalidArgument for another architecture.
Result<NetworkModel> ReadUnseen(const std::filesystem::path& file, Architecture architecture,
                                const EvaluateArguments& arguments, const EvaluationData& data,
                                const Reporter& warn) {
  auto model = ReadWeightsFile(file);
  if (!model) return model;
  if (model->weights.shape.architecture != architecture) {
    return Fail(ErrorCode::kInvalidArgument,
                file.string() + ": --weights takes model nhpm, --encoder-decoder the other one");
  }
  const auto unseen = CheckUnseen(*model, file, data, arguments.allow_seen);
  if (!unseen) return tl::unexpected(unseen.error());
  if (!unseen->empty()) warn(*unseen);
  return model;
}

/// One row per weights file and one more for each input left out: keys nhpm, nhpm_2, ...,
/// nhpm_without_tau, ... Reports warnings. Errors name the file.
Result<std::vector<ModelRow>> NetworkRows(const EvaluateArguments& arguments,
                                          const EvaluationData& data, const Reporter& warn,
                                          const Reporter& progress) {
  const std::vector<std::filesystem::path> files = Files(arguments, warn);
  std::vector<ModelRow> rows;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto model = ReadUnseen(files[i], Architecture::kConvolutional, arguments, data, warn);
    if (!model) return tl::unexpected(model.error());
    std::vector<NamedNetwork> networks{Named(*model, files[i], i)};
    for (const std::string& input : arguments.without) {
      InputSelection seen = model->inputs;
      if (InputOf(seen, input)) {
        networks.push_back(Without(networks.front(), input));
      } else {
        warn(fmt::format("{}: trained without {}; no further row without it", files[i].string(),
                         input));
      }
    }
    for (const NamedNetwork& network : networks) {
      auto row = RowOf(network, data, progress);
      if (!row) {
        return Fail(row.error().code, fmt::format("{}: {}", files[i].string(), row.error().text));
      }
      rows.push_back(std::move(*row));
    }
  }
  return rows;
}

/// Whether the editors of the test part are known: synthetic annotators, all of them.
bool HasOracle(const EvaluationData& data) {
  return std::ranges::all_of(data.test.trajectories, IsSynthetic);
}

/// The synthetic annotators themselves (key oracle), and the best possible model that does not know
/// who looked (key oracle_average): the mean over people of the train part. Empty for data of
/// people or of a simulated operator.
/// Errors: those of OracleAnswers, with the file; kInvalidArgument when the train part has no
///         synthetic people.
Result<std::vector<ModelRow>> OracleRows(const EvaluateArguments& arguments,
                                         const EvaluationData& data, const Reporter& progress) {
  std::vector<ModelRow> rows;
  if (arguments.oracle_draws == 0 || !HasOracle(data)) return rows;
  auto oracle = OracleRow(arguments, data, progress);
  if (!oracle) return tl::unexpected(oracle.error());
  rows.push_back(std::move(*oracle));
  if (!arguments.average_oracle) return rows;
  auto average = AverageRow(arguments, data, progress);
  if (!average) return tl::unexpected(average.error());
  rows.push_back(std::move(*average));
  return rows;
}

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
  std::vector<FileOption> inputs{{"--data", arguments.data},
                                 {"--encoder-decoder", arguments.encoder_decoder}};
  for (const auto& weights : arguments.weights) inputs.push_back({"--weights", weights});
  return CheckFiles(
      kProgram, inputs,
      {{"--json", arguments.json}, {"--csv", arguments.csv}, {"--html", arguments.html}});
}

int RunOnCanvas(const EvaluateArguments& arguments, const EvaluationReport& report) {
  const Reporter warn = [](const std::string& text) { Warn(kProgram, text); };
  const auto network = ReadUnseen(arguments.encoder_decoder, Architecture::kEncoderDecoder,
                                  arguments, report.data, warn);
  if (!network) return Failed(kProgram, network.error());
  EncoderDecoderModel model(*network);
  const auto rows = EvaluateOnCanvas(report.data, report.rows, model);
  if (!rows) return Failed(kProgram, rows.error());
  const auto json = WriteJsonOutput(arguments.json, CanvasJson(report.data, *rows));
  if (!json || arguments.json == "-") return ExitCode(kProgram, json);
  return ExitCode(kProgram,
                  WriteStandardOutput(DescribeData(report.data) + "\n" + CanvasTable(*rows)));
}

int RunEvaluate(const EvaluateArguments& arguments) {
  if (const int code = CheckEvaluateFiles(arguments); code != 0) return code;
  auto data = LoadEvaluationData(
      arguments.data, arguments.all_test ? std::nullopt : std::optional(arguments.split_seed));
  if (!data) return Failed(kProgram, data.error());
  const std::string wrong = WrongUse(arguments, *data);
  if (!wrong.empty()) return Refused(kProgram, wrong);
  EvaluationReport report;
  report.data = std::move(*data);
  auto rows = AllRows(arguments, report.data);
  if (!rows) return Failed(kProgram, rows.error());
  report.rows = std::move(*rows);
  if (!arguments.encoder_decoder.empty()) return RunOnCanvas(arguments, report);
  report.bars = CheckBars(report.data, report.rows);
  report.figures = Figures(arguments, report);
  if (const int code = WriteAll(arguments, report); code != 0) return code;
  if (!arguments.check) return 0;
  if (report.bars.empty()) return Refused(kProgram, "--check: needs an NHPM row");
  return std::ranges::all_of(report.bars, &Bar::passed) ? 0 : 1;
}

void AddDataFlags(CLI::App& app, EvaluateArguments& arguments) {
  app.add_option("--data", arguments.data,
                 "Segment file of conav dataset; required without --train-on");
  auto* seed = AddSeed(app, "--split-seed", arguments.split_seed,
                       "Seed of the split: use the one given to conav train");
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
      ->check(CLI::IsMember({0}) | Between(2000, 100000000));
  app.add_flag("--average-oracle", arguments.average_oracle,
               "One more row: the mean over synthetic annotators, the best possible model that "
               "does not know the person");
  arguments.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--threads", arguments.threads,
                 "Threads [one per core]; the result is the same on any number")
      ->check(Between(1, 256));
}

void AddOutputFlags(CLI::App& app, EvaluateArguments& arguments) {
  auto* rasters = app.add_option(
      "--encoder-decoder", arguments.encoder_decoder,
      "Weights file of conav train --model encoder-decoder: compares it with the other models, "
      "whose answers are scaled up, on test segments pasted on canvases as in its training");
  app.add_option("--json", arguments.json,
                 "Write all figures to this file, - = standard output (the table then goes to "
                 "standard error)");
  app.add_option("--csv", arguments.csv, "Write a line per model to this file, or -")
      ->excludes(rasters);
  app.add_option("--html", arguments.html,
                 "Write a page with table, plots and figure 3 to this file, or -")
      ->excludes(rasters);
  app.add_option("--segments", arguments.segments,
                 "Test segments for the page, numbers from 0 [those with a misplaced near wall, a "
                 "preferred far wall, and the largest differences between NHPM and GLPF-Test]")
      ->check(WholeNumber())
      ->delimiter(',');
  app.add_flag("--check", arguments.check, "Exit with 1 when a bar is missed; synthetic data only")
      ->excludes(rasters);
}

/// Reports wrong usage that CLI11 does not detect; empty = none.
std::string WrongUse(const EvaluateArguments& arguments) {
  if (arguments.data.empty()) return "--data is required";
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
}  // namespace conav::nhpm

int main(int argc, char** argv) {
  using namespace conav::nhpm;
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
  MatrixArguments matrix;
  AddDataFlags(app, arguments);
  AddModelFlags(app, arguments);
  AddOutputFlags(app, arguments);
  AddMatrixFlags(app, matrix);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  if (matrix.wanted()) {
    for (const char* option :
         {"--data", "--split-seed", "--all-test", "--allow-seen", "--weights", "--without",
          "--average-oracle", "--encoder-decoder", "--csv", "--segments"}) {
      if (app.count(option) == 0) continue;
      return conav::Refused(kProgram, fmt::format("--train-on excludes {}", option));
    }
    matrix.check = arguments.check;
    matrix.oracle_draws = arguments.oracle_draws;
    matrix.threads = arguments.threads;
    matrix.json = arguments.json;
    matrix.html = arguments.html;
    conav::InstallStopSignals();
    return RunMatrix(matrix, conav::ProcessStopToken());
  }
  const std::string wrong = WrongUse(arguments);
  if (!wrong.empty()) return conav::Refused(kProgram, wrong);
  return RunEvaluate(arguments);
}
