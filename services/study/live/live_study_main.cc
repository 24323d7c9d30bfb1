#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <string>

#include "common/cli/cli.h"
#include "study/live/session.h"

// conav-live-study: leads one participant through a protocol.

namespace conav::live_study {
namespace {

constexpr const char* kProgram = "conav study --live";

constexpr const char* kAbout =
    R"(A study with PEOPLE: leads one participant through a protocol, on one page in their browser:
consent, questions, a rest, training, one maze after the other with each method in the participant's
order, questionnaires between them, debriefing. The protocol that comes with conav compares the methods
of the paper's user study (section 6.2); copy it and its forms, and change it: docs/study-protocol.md.

A service that dies is started again, and after Ctrl-C, a kill or a crash the same command goes on in
the same step. The folder of a study has one folder for each participant; docs/study.md begins with an
empty machine.)";

constexpr const char* kExamples =
    R"(Examples:
  conav study --live --participant P01
  conav study --live --participant P01 --protocol my-study/study.yaml --check-protocol
  conav study --live --participant P01 --eye-tracker tcp://127.0.0.1:50020

Exit codes: 0 all steps finished, or the session was aborted; 1 interrupted, a service cannot run, the
port is taken, writing failed; 2 wrong usage, wrong protocol, the folder belongs to another one.)";

struct StudyArguments {
  SessionOptions options;
  std::filesystem::path protocol = ShippedProtocol();
  std::string eye_tracker;
  int order = 0;
  bool only_check = false;
};

int Run(const StudyArguments& arguments) {
  SessionOptions options = arguments.options;
  if (const auto valid = Validate(options); !valid) return Refused(kProgram, valid.error().text);
  Protocol protocol;
  try {
    protocol = ReadProtocol(arguments.protocol);
  } catch (const StartupError& error) {
    return Refused(kProgram, error.what());
  }
  auto plan = PlanParticipant(protocol, options.participant, arguments.order);
  if (!plan) return Refused(kProgram, plan.error().text);
  if (!arguments.eye_tracker.empty()) plan->eye_tracker.address = arguments.eye_tracker;
  for (const std::string& gap : GapsOf(protocol)) {
    fmt::print(stderr, "{}: not filled yet in {}\n", kProgram, gap);
  }
  if (arguments.only_check) return ExitCode(kProgram, WriteStandardOutput(Describe(*plan)));
  if (options.out.empty()) options.out = "runs/study-" + protocol.name;
  const std::filesystem::path study = std::filesystem::absolute(options.out);
  std::error_code error;
  std::filesystem::create_directories(study, error);
  const auto kept = KeepProtocol(protocol, study);
  if (!kept && kept.error().code == ErrorCode::kRefused) {
    return Refused(kProgram, kept.error().text);
  }
  if (!kept) return Failed(kProgram, kept.error());
  return RunSession(kProgram, *plan, options, study / options.participant,
                    {study, protocol.completion_code});
}

}  // namespace
}  // namespace conav::live_study

int main(int argc, char** argv) {
  using namespace conav::live_study;
  CLI::App app(kAbout, kProgram);
  StudyArguments arguments;
  AddSessionOptions(app, arguments.options);
  app.add_option("--protocol", arguments.protocol, "The protocol [the one that comes with conav]")
      ->check(CLI::ExistingFile);
  app.add_option("--order", arguments.order,
                 "Row of the Williams design [by the number at the end of the participant's code]")
      ->check(conav::Between(1, 100));
  app.add_option("--eye-tracker", arguments.eye_tracker,
                 "Address of Pupil Remote, instead of the protocol's");
  app.add_flag("--check-protocol", arguments.only_check,
               "Only check the protocol, and print the participant's steps");
  app.add_option("--out", arguments.options.out, "Folder of the study [runs/study-NAME]");
  app.footer(kExamples);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return RunGuarded(kProgram, [&] { return Run(arguments); });
}
