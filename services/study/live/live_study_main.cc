#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "common/cli/cli.h"
#include "study/design.h"
#include "study/live/task_command.h"

// conav-live-study: one participant at the console tries one method after the other.

namespace {

constexpr const char* kProgram = "conav study --live";

constexpr const char* kAbout =
    R"(The methods of the paper's user study (section 6.2) with a PERSON: one maze per method, one
after the other on one page, which explains the method and shows only its tools. Each part begins with
"Begin" and may be finished once the robot has reached all goals; then the next one follows. Training
mazes, questionnaires and eye tracking are not included.

Order: a row of the Williams design of the methods, by the participant's code, or --order. The folder gets
result.json (per part: method, maze, mapping accuracy, edits, pictures, time) and segments.pb.zst. After
Ctrl-C or a kill the same command resumes at the first unfinished part. Details: docs/mapping-task.md.)";

constexpr const char* kExamples =
    R"(Examples:
  conav study --live --participant P07
  conav study --live --participant P07 --methods ig-mcts,teleop --order 2

Exit codes: 0 all parts finished; 1 interrupted, a service died, the port is taken, writing failed;
2 wrong usage.)";

}  // namespace

int main(int argc, char** argv) {
  using namespace conav::mapping_task;
  CLI::App app(kAbout, kProgram);
  TaskOptions options;
  options.speed = 2.0;
  AddTaskOptions(app, options);
  std::vector<std::string> methods = conav::Names(conav::study::kStudyMethods);
  int order = 0;
  app.add_option("--methods", methods, "Methods, of ig-mcts, instruction, teleop")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--order", order, "Row of the Williams design [by the participant's code]")
      ->check(conav::Between(1, 100));
  app.footer(kExamples);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  const auto ordered = conav::study::ParseMethods(methods, conav::study::kStudyMethods)
                           .and_then([&](const auto& all) {
                             return MethodsInOrder(all, order, options.participant);
                           });
  if (!ordered) return conav::Refused(kProgram, ordered.error().text);
  options.methods = *ordered;
  options.mazes = static_cast<int>(ordered->size());
  return RunTaskCommand(kProgram, options);
}
