// conav-bag: what is in a run's recording, and the same as a rosbag2 folder.
#include <CLI/CLI.hpp>

#include "operator/commands/bag_command.h"

namespace {

constexpr const char* kAbout =
    R"(Says what is in the recording of a run, and writes it as a rosbag2 folder.

RUN is a run folder (./conav demo leaves runs/<time>-seed<S>) or an MCAP file. A recording that was cut
off (its process was killed, the disk was full, or it is still being written) is read up to its last
whole chunk, with a warning. docs/recording.md says more.

Exit codes: 0 done; 1 no such recording, or it cannot be read, or writing failed; 2 wrong use.

Examples:
  conav bag runs/20261121-172744-seed7
  conav bag runs/20261121-172744-seed7 --rosbag2 /tmp/bag && ros2 bag info /tmp/bag)";

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(kAbout, "conav bag");
  conav::bag::BagArguments arguments;
  app.add_option("run", arguments.run, "The run")->required()->type_name("RUN");
  app.add_option(
         "--rosbag2", arguments.rosbag2,
         "Write all messages into this new folder: SQLite and metadata.yaml, as ROS 2 Humble "
         "and later ones read them")
      ->type_name("DIR");
  app.add_option(
      "--json", arguments.json,
      "Write what is printed to this file, too; - = standard output (the table then goes "
      "to standard error)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return conav::bag::RunBag(arguments);
}
