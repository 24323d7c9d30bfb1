#include "common/service/service_main.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>

namespace conav {

std::string ParseConfigFlag(const std::string& service, const std::string& description, int argc,
                            char** argv) {
  std::string name = service;
  std::ranges::replace(name, '_', '-');
  CLI::App app{description + "\nRuns until SIGINT or SIGTERM; logs to stderr.", "conav up " + name};
  std::string file;
  app.add_option(
         "--config", file,
         "YAML file with the section '" + service +
             ": ros__parameters:'; see deploy/config for an example. Unknown keys are rejected.")
      ->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == 0 ? 0 : 2);
  }
  return file;
}

}  // namespace conav
