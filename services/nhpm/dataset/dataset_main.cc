#include <fmt/format.h>

#include "common/cli/cli.h"
#include "nhpm/dataset/dataset_commands.h"

// conav-dataset: makes, converts and shows segments, the training data of perception models.

int main(int argc, char** argv) {
  CLI::App app{
      "Segments: how a person edited the map after each picture (x, tau, o, x' of the "
      "paper's\nAppendix A). They come from synthetic annotators, from recorded sessions, or from "
      "an import.",
      "conav dataset"};
  app.require_subcommand(1);
  int exit_code = 0;
  conav::nhpm::AddSynthesizeCommand(app, exit_code);
  conav::nhpm::AddDescribeCommand(app, exit_code);
  conav::nhpm::AddImportCommand(app, exit_code);
  conav::nhpm::AddExportCommand(app, exit_code);
  conav::nhpm::AddMergeCommand(app, exit_code);
  conav::nhpm::AddSplitCommand(app, exit_code);
  if (conav::NamesUnknownCommand(app, argc, argv)) {
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
