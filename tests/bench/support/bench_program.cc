#include "bench/support/bench_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>

#include "common/cli/cli.h"
#include "common/runtime/log.h"
#include "common/runtime/text.h"

namespace conav::bench {

void AddUsualOptions(CLI::App& app, std::string& json_file, int& rounds) {
  app.add_option("--json", json_file, "Write figures to this file")->check(WritableFile());
  AddNumber(app, "--rounds", rounds, "Repetitions; medians are over these", {1, 1000});
}

void ShowRound(int round, int rounds) {
  if (isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\rround {} of {} {}", round + 1, rounds, round + 1 == rounds ? "\n" : "");
}

void WriteFigures(const std::string& json_file, const nlohmann::ordered_json& document) {
  if (json_file.empty()) return;
  const auto written = WriteJsonFile(json_file, document);
  if (!written) throw StartupError(written.error().text);
}

int RunBenchmark(CLI::App& app, int argc, char** argv, const std::function<void()>& run) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  log::SetMinimumLevel(log::Level::kWarning);
  try {
    run();
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), error.what());
    return 1;
  }
}

}  // namespace conav::bench
