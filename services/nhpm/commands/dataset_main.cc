// conav-dataset: makes, converts and shows segments, what perception models learn from.
#include <fmt/format.h>

#include "nhpm/commands/dataset_commands.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Segments: how somebody edited their map after each picture (x, tau, o, x' of the paper's\n"
      "Appendix A). Made by synthetic annotators, recorded by every session, or imported.",
      "conav dataset"};
  app.require_subcommand(1);
  int exit_code = 0;
  conav::nhpm::AddSynthesizeCommand(app, exit_code);
  conav::nhpm::AddDescribeCommand(app, exit_code);
  conav::nhpm::AddImportCommand(app, exit_code);
  conav::nhpm::AddExportCommand(app, exit_code);
  conav::nhpm::AddMergeCommand(app, exit_code);
  conav::nhpm::AddSplitCommand(app, exit_code);
  // CLI11 would only say that it wants a subcommand.
  const auto is_first = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(is_first).empty()) {
    return conav::Refused(
        conav::nhpm::kDatasetProgram,
        fmt::format("there is no command '{}'; conav dataset --help lists them", argv[1]));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_code;
}
