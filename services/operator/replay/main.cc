// conav-replay: a recorded run in the console's page.
#include <CLI/CLI.hpp>

#include "operator/replay/replay_command.h"

namespace {

constexpr const char* kAbout =
    R"(Shows a recorded run in the console's page: play, pause, go to any time, picture, edit or alert.
The true map, which nobody knew during the run, is a layer of its own.

RUN is a run folder (./conav demo leaves runs/<time>-seed<S>) or an MCAP file. A recording that was cut
off (its process was killed, the disk was full, or it is still being written) is played as far as it
goes, with a warning. docs/console.md says more.

Exit codes: 0 ended by Ctrl-C; 1 no such recording, it cannot be read, or the port is taken; 2 wrong use.

Examples:
  conav replay runs/20261121-172744-seed7
  conav replay runs/20261121-172744-seed7 --port 0)";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, "conav replay");
  conav::operators::ReplayArguments arguments;
  app.add_option("run", arguments.run, "The run")->required()->type_name("RUN");
  app.add_option("--port", arguments.port,
                 "Port of the page on this machine; 0 = any that is free (default 8080)")
      ->check(CLI::Range(0, 65535));
  app.add_option("--url-file", arguments.url_file, "Write the page's address to this file")
      ->type_name("FILE");
  app.add_option("--web", arguments.web, "Folder of another page than the one that was built")
      ->type_name("DIR");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return conav::operators::RunReplay(arguments);
}
