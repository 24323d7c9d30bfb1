// conav-study: the methods side by side, with simulated operators.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <thread>

#include "common/console/option_checks.h"
#include "common/runtime/log.h"
#include "common/runtime/stop_token.h"
#include "study/study_command.h"
#include "study/supervision_command.h"

namespace {

constexpr const char* kAbout =
    R"(The paper's user study (section 6.2, table 3) with SIMULATED operators: everybody has every method
on every layout, each episode with all services as processes of their own over DDS. Prints, per method,
communication, steps, guidance, mapping accuracy, goals and time, what tests say, and whether the bars
hold.

Design: order of methods counterbalanced by a Williams design; layouts are mazes 234, 666 and 9, then
random ones, turned by another quarter in each session; operators are synthetic people, each drawn from
a population and the same in all methods. docs/study.md says more.

Each episode is on disk when it has ended: after a kill the same command goes on. Another design in the
same --out is refused. An episode that does not reach all goals is run a second time, then kept and
reported.

Another study, of one operator with many robots: conav study --supervision --help. With a person: conav
study --live --help.)";

constexpr const char* kExitCodes =
    R"(Exit codes: 0 done; 1 an episode failed, interrupted, writing failed, or with --check a bar missed;
2 wrong use.)";

void AddOptions(CLI::App& app, conav::study::StudyOptions& options) {
  app.add_option("--operators", options.design.operators, "Simulated operators")
      ->capture_default_str();
  app.add_option("--layouts", options.design.layouts, "Mazes for each of them")
      ->capture_default_str();
  app.add_option("--methods", options.design.methods, "Methods, as conav demo --method knows them")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--robots", options.robots, "Robots that an operator has")->capture_default_str();
  app.add_option("--seed", options.design.seed, "Seed of orders, people and random layouts")
      ->check(conav::WholeNumber())
      ->capture_default_str();
  options.jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--jobs", options.jobs, "Episodes at once")->capture_default_str();
  app.add_option("--camera", options.camera, "egl renders pictures; none sends them without pixels")
      ->capture_default_str();
  app.add_option(
      "--population", options.population,
      "Whom the operators are drawn from, a file like deploy/config/annotators.yaml [its "
      "careful people]");
  app.add_option("--weights", options.weights,
                 "Weights file of the perception model [the one that comes with conav]");
  app.add_option("--dds", options.dds, "cyclonedds, fastdds, mixed or SERVICE=VENDOR,...");
  app.add_flag("--recording", options.recording, "Record each episode, as conav demo does");
  app.add_option("--time-limit", options.time_limit_s, "Seconds that an episode may take")
      ->capture_default_str();
  app.add_option("--out", options.out, "Folder of the study [one in runs/, named by the design]");
  app.add_option("--json", options.json,
                 "Write the result to this file, too; - = standard output (the tables then go to "
                 "standard error)");
  app.add_flag("--check", options.check, "A missed bar is a failure");
  app.footer(kExitCodes);
}

}  // namespace

int main(int argc, char** argv) {
  const auto is_supervision = [](const char* word) {
    return std::string_view(word) == "--supervision";
  };
  if (std::any_of(argv + 1, argv + argc, is_supervision)) {
    return conav::study::SupervisionMain(argc, argv);
  }
  CLI::App app(kAbout, "conav study");
  conav::study::StudyOptions options;
  AddOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  conav::log::SetService("study");
  conav::log::SetMinimumLevel(conav::log::Level::kError);
  conav::InstallStopSignals();
  return conav::study::RunStudy(options, conav::study::DescribeRun(argc, argv),
                                conav::ProcessStopToken());
}
