// conav-dataset: makes, converts and shows segments, what perception models learn from.
#include "nhpm/commands/dataset_commands.h"

int main(int argc, char** argv) {
  CLI::App app{
      "Segments: how somebody edited their map after each picture (x, tau, o, x' of the paper's\n"
      "Appendix A). Made by synthetic annotators, recorded by every session, or imported."};
  app.require_subcommand(1);
  int exit_code = 0;
  conav::nhpm::AddSynthesizeCommand(app, exit_code);
  conav::nhpm::AddDescribeCommand(app, exit_code);
  conav::nhpm::AddImportCommand(app, exit_code);
  conav::nhpm::AddExportCommand(app, exit_code);
  conav::nhpm::AddMergeCommand(app, exit_code);
  conav::nhpm::AddSplitCommand(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return exit_code;
}
