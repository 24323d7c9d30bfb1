// `conav train --sweep`: the same training with several values of its options.
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "nhpm/training/train_command.h"

namespace conav::nhpm {
namespace {

constexpr const char* kProgram = "conav train";
constexpr std::size_t kMostTrainings = 10000;

/// An option without its dashes, and the values that it takes.
struct Axis {
  std::string option;
  std::vector<std::string> values;
};

std::optional<int> ReadInt(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "1..5" or "a,b,c".
std::vector<std::string> ReadValues(const std::string& text) {
  std::vector<std::string> values;
  const std::size_t dots = text.find("..");
  const auto first = ReadInt(text.substr(0, dots));
  const auto last = dots == std::string::npos ? std::nullopt : ReadInt(text.substr(dots + 2));
  if (first && last && *last - *first < static_cast<int>(kMostTrainings)) {
    for (int value = *first; value <= *last; ++value) values.push_back(std::to_string(value));
    return values;
  }
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    values.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return values;
}

/// Throws StartupError.
std::vector<Axis> ReadAxes(const std::vector<std::string>& sweep) {
  std::vector<Axis> axes;
  std::size_t trainings = 1;
  for (const std::string& text : sweep) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos) {
      throw StartupError(fmt::format("--sweep {}: expected OPTION=VALUES, as seed=1..5", text));
    }
    axes.push_back({text.substr(0, equals), ReadValues(text.substr(equals + 1))});
    trainings *= axes.back().values.size();
    if (trainings == 0 || trainings > kMostTrainings) {
      throw StartupError(fmt::format("--sweep {}: {} trainings; 1 to {} are allowed", text,
                                     trainings, kMostTrainings));
    }
  }
  return axes;
}

std::size_t CountOf(const std::vector<Axis>& axes) {
  std::size_t count = 1;
  for (const Axis& axis : axes) count *= axis.values.size();
  return count;
}

/// The value of each axis in training `index`; the last axis changes first.
std::vector<std::string> ChoiceOf(const std::vector<Axis>& axes, std::size_t index) {
  std::vector<std::string> choice(axes.size());
  for (std::size_t i = axes.size(); i-- > 0;) {
    choice[i] = axes[i].values[index % axes[i].values.size()];
    index /= axes[i].values.size();
  }
  return choice;
}

/// "width=32 seed=2"; without seeds if they are left out.
std::string NameOf(const std::vector<Axis>& axes, const std::vector<std::string>& choice,
                   bool with_seed) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (with_seed || axes[i].option != "seed") {
      parts.push_back(fmt::format("{}={}", axes[i].option, choice[i]));
    }
  }
  return parts.empty() ? "all" : Join(parts, " ");
}

struct Trained {
  std::string name;
  std::string setting;  // the name without the seed
  std::filesystem::path weights;
  int best_epoch = 0;
  double validation = 0.0;
  double test = 0.0;
};

Result<Trained> ReadTrained(const std::vector<Axis>& axes, std::size_t index, const Batch& batch) {
  const std::filesystem::path file = batch.FileOf(index, ".json");
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  try {
    const auto report = nlohmann::json::parse(*text);
    const auto choice = ChoiceOf(axes, index);
    return Trained{NameOf(axes, choice, true),
                   NameOf(axes, choice, false),
                   report.at("weights").get<std::string>(),
                   report.at("best_epoch"),
                   report.at("validation_mbce"),
                   report.at("test_mbce")};
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, fmt::format("{}: {}", file.string(), error.what()));
  }
}

/// A line for each setting, the best mean first: over its seeds.
std::string TableOf(const std::vector<Trained>& trained) {
  struct Row {
    double mean;
    std::string text;
  };
  std::vector<Row> rows;
  std::size_t width = 7;
  for (const Trained& one : trained) width = std::max(width, one.setting.size());
  std::vector<std::string> settings;
  for (const Trained& one : trained) {
    if (std::ranges::count(settings, one.setting) == 0) settings.push_back(one.setting);
  }
  for (const std::string& setting : settings) {
    std::vector<Trained> runs;
    std::ranges::copy_if(trained, std::back_inserter(runs),
                         [&](const Trained& one) { return one.setting == setting; });
    const auto count = static_cast<double>(runs.size());
    double mean = 0.0;
    double square = 0.0;
    for (const Trained& run : runs) mean += run.validation / count;
    for (const Trained& run : runs) square += (run.validation - mean) * (run.validation - mean);
    const double sd = runs.size() > 1 ? std::sqrt(square / (count - 1.0)) : 0.0;
    const auto best = std::ranges::min_element(runs, {}, &Trained::validation);
    rows.push_back(
        {mean, fmt::format("{:{}}  {:>9}  {:>9.5f}  {:>9.5f}  {:>9.5f}  {:>9.5f}\n", setting, width,
                           runs.size(), mean, sd, best->validation, best->test)});
  }
  std::ranges::stable_sort(rows, {}, &Row::mean);
  std::string table = fmt::format("{:{}}  {:>9}  {:>9}  {:>9}  {:>9}  {:>9}\n", "setting", width,
                                  "trainings", "mean", "sd", "best", "its test");
  for (const Row& row : rows) table += row.text;
  return table;
}

nlohmann::ordered_json JsonOf(const std::vector<Trained>& trained, const Trained& best) {
  auto rows = nlohmann::ordered_json::array();
  for (const Trained& one : trained) {
    rows.push_back({{"name", one.name},
                    {"weights", one.weights.string()},
                    {"best_epoch", one.best_epoch},
                    {"validation_mbce", one.validation},
                    {"test_mbce", one.test}});
  }
  return {{"best", best.name}, {"trainings", rows}};
}

Result<void> Report(const std::vector<Trained>& trained, const TrainArguments& arguments) {
  const auto best = std::ranges::min_element(trained, {}, &Trained::validation);
  const std::string text =
      fmt::format("validation loss of {} trainings\n{}best: {}, written to {}\n", trained.size(),
                  TableOf(trained), best->name, arguments.out.string());
  return ReadFile(best->weights)
      .and_then([&](const std::string& bytes) { return WriteFile(arguments.out, bytes); })
      .and_then([&] { return WriteJsonOutput(arguments.json, JsonOf(trained, *best)); })
      .and_then([&]() -> Result<void> {
        return arguments.json == "-" ? Result<void>() : WriteStandardOutput(text);
      });
}

/// Whether the best weights may be written: nothing is lost, as they are there again, or on request.
bool IsReplaceable(const TrainArguments& arguments, const Batch& batch, std::size_t count) {
  const auto there = ReadFile(arguments.out);
  if (arguments.overwrite || batch.piece() || !there) return true;
  for (std::size_t index = 0; index < count; ++index) {
    const auto own = ReadFile(batch.folder() / fmt::format("{}.nhpm", index));
    if (own && *own == *there) return true;
  }
  return false;
}

}  // namespace

int RunSweep(const std::vector<std::string>& sweep, const TrainArguments& arguments,
             const Batch& batch, const TrainOne& train) {
  const int code = CheckFiles(kProgram, {{"--data", arguments.data}},
                              {{"--out", arguments.out}, {"--json", arguments.json}});
  if (code != 0) return code;
  const std::vector<Axis> axes = ReadAxes(sweep);
  if (!IsReplaceable(arguments, batch, CountOf(axes))) {
    return Refused(kProgram,
                   fmt::format("--out {}: holds other weights than this sweep's; --overwrite "
                               "replaces them",
                               arguments.out.string()));
  }
  batch.Start(CountOf(axes));
  std::vector<Trained> trained;
  for (std::size_t index = 0; index < CountOf(axes); ++index) {
    if (batch.piece() && *batch.piece() != index) continue;
    const std::filesystem::path record = batch.FileOf(index, ".json");
    if (!std::filesystem::exists(record)) {
      auto words = CommandWithout(
          {"--sweep", "--records", "--slurm", "--piece", "--out", "--json", "--svg"});
      const auto weights = batch.folder() / fmt::format("{}.nhpm", index);
      for (const char* word : {"--no-svg", "--json", record.c_str(), "--out", weights.c_str()}) {
        words.emplace_back(word);
      }
      const auto choice = ChoiceOf(axes, index);
      for (std::size_t i = 0; i < axes.size(); ++i) {
        words.push_back(fmt::format("--{}={}", axes[i].option, choice[i]));
      }
      if (const int ended = train(words); ended != 0) return ended;
    }
    auto one = ReadTrained(axes, index, batch);
    if (!one) return Failed(kProgram, one.error());
    trained.push_back(*std::move(one));
  }
  if (batch.piece()) return 0;
  return ExitCode(kProgram, Report(trained, arguments));
}

}  // namespace conav::nhpm
