#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/cli/cli.h"
#include "nhpm/engine/network_weights.h"

/// What all benchmarks share: a program around the measuring, medians over rounds, clocks, and the
/// limit of the processor.
namespace conav::bench {

using Json = nlohmann::ordered_json;

/// Options, rounds, figures' file and exit code of a benchmark. It has --json and --rounds; a file
/// that cannot be written is wrong use.
class BenchProgram {
 public:
  /// `name` as in messages: "conav bench bus", whose last word is the benchmark's name in JSON.
  BenchProgram(const std::string& name, const std::string& about, int rounds);

  CLI::App& app() { return app_; }
  int rounds() const { return rounds_; }
  /// An option for a number from `low` to `high`, whose help shows the default.
  template <class T>
  void AddNumber(const std::string& name, T& value, const std::string& help,
                 std::type_identity_t<T> low, std::type_identity_t<T> high) {
    app_.add_option(name, value, help)->capture_default_str()->check(Between(low, high));
  }

  /// Calls `round` for each round; shows on a terminal how far it is.
  void ForEachRound(const std::function<void()>& round) const;
  /// Writes `figures` behind benchmark and machine, unless no file was asked for. Throws
  /// StartupError.
  void Write(const Json& figures) const;
  /// Parses and runs. Returns the exit code: 0; 1 with a message when `run` throws; 2 for wrong
  /// use.
  int Run(int argc, char** argv, const std::function<void()>& run);

 private:
  CLI::App app_;
  int rounds_;
  std::string json_file_;
};

/// Adds --width of the network.
void AddWidth(BenchProgram& program, int& width);

/// 0 of no values.
double Median(std::vector<double> values);
/// The smallest value that at least this share of the others does not exceed; 0 of no values.
double Quantile(std::vector<double> values, double share);

/// Figures by name, a value for each round. What is compared is divided within a round, which saw one
/// machine.
class Rounds {
 public:
  void Add(std::initializer_list<std::pair<std::string, double>> values);
  double Median(const std::string& name) const { return bench::Median(Of(name)); }
  std::vector<double> Of(const std::string& name) const {
    return values_.value(name, Json::array());
  }
  /// The median of each figure, in the order in which they were added first.
  Json Medians() const;

 private:
  Json values_ = Json::object();
};

/// What the figures were measured on.
std::string Machine();

/// Processor time of the calling thread: what other programs do does not count.
double ThreadSeconds();
double ThreadSecondsOf(const std::function<void()>& call);
double WallSecondsOf(const std::function<void()>& call);

/// Of one forward pass over so many cells; a multiply-add counts as two.
double FlopsOfPass(const nhpm::NetworkShape& shape, int cells);

/// Floats in the widest vector that this processor multiplies and adds: 16, 8, or 0 without AVX2.
int WidestFmaLanes();
/// What one core does at most with vectors of `lanes` floats (WidestFmaLanes() or fewer), GFLOP/s
/// (an FMA counts as two), in registers, no memory. About 10 ms of processor time. 0 for 0 lanes.
double MeasureFmaPeak(int lanes);
/// With the widest vectors, the sum over as many threads at once: two of them may share one core.
double MeasureFmaPeakOfThreads(int threads);

}  // namespace conav::bench
