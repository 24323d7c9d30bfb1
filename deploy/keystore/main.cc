// conav-keystore: keys and permissions of DDS security.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "common/cli/cli.h"
#include "common/runtime/text.h"
#include "keystore/keystore.h"

namespace conav::keystore {
namespace {

constexpr const char* kProgram = "conav keystore";
constexpr int kLongestDays = 36500;

struct Arguments {
  std::filesystem::path keystore;
  Host host;
  int authority_days = 7300;
  int days = 3650;
};

/// Every host of a system with robots of its own runs these by default.
std::vector<std::string> AllRoles() { return {kRoles.begin(), kRoles.end()}; }

CLI::Validator NameOf(const char* what, const std::string& also) {
  return CLI::Validator(
      [what, also](const std::string& text) {
        const auto allowed = [&](unsigned char c) {
          return std::isalnum(c) != 0 || c == '_' ||
                 also.find(static_cast<char>(c)) != std::string::npos;
        };
        const bool is_name =
            !text.empty() && text.size() <= 200 && std::ranges::all_of(text, allowed);
        return is_name ? std::string() : fmt::format("'{}' is not the name of a {}", text, what);
      },
      "");
}

void AddKeystore(CLI::App& command, Arguments& arguments) {
  command.add_option("--keystore", arguments.keystore, "Folder of the keystore")
      ->envname("ROS_SECURITY_KEYSTORE")
      ->required();
}

void AddDays(CLI::App& command, Arguments& arguments) {
  AddNumber(command, "--days", arguments.days, "Until the certificates end", 1, kLongestDays);
}

/// Runs `work` and prints what to do next.
void OnCall(CLI::App& command, Arguments& arguments, int& exit_code,
            std::function<std::string()> work) {
  command.callback([&arguments, &exit_code, work = std::move(work)] {
    arguments.host.name = HostFolder(arguments.host.name);
    try {
      fmt::print("{}\n", work());
    } catch (const std::exception& error) {
      exit_code = Failed(kProgram, {ErrorCode::kIo, error.what()});
    }
  });
}

std::string Moved(const Arguments& arguments) {
  return fmt::format(
      "Copy to the host: rsync -a --relative {0}/./enclaves/conav/{1} {1}:keystore/\n"
      "Restart its programs with ROS_SECURITY_ENABLE=true ROS_SECURITY_KEYSTORE=keystore",
      arguments.keystore.string(), arguments.host.name);
}

constexpr const char* kListChanged =
    "Copy the enclaves to all hosts and restart their programs: they learn from crl.pem which "
    "certificates "
    "no longer count.";

void AddInit(CLI::App& app, Arguments& arguments, int& exit_code) {
  CLI::App& command =
      *app.add_subcommand("init", "Makes a keystore: an authority and the rules of the bus");
  AddKeystore(command, arguments);
  AddNumber(command, "--days", arguments.authority_days,
            "Until the authority ends, and all with it", 1, kLongestDays);
  OnCall(command, arguments, exit_code, [&] {
    Init(arguments.keystore, arguments.authority_days);
    return fmt::format(
        "Keep {}/private on this machine: its key signs certificates and permissions.",
        arguments.keystore.string());
  });
}

void AddAdd(CLI::App& app, Arguments& arguments, int& exit_code) {
  CLI::App& command = *app.add_subcommand(
      "add",
      "Makes keys and permissions for the programs of a host, as the table of topics has them");
  command.add_option("HOST", arguments.host.name, "As `hostname` prints it there")
      ->required()
      ->check(NameOf("host", ".-"));
  AddKeystore(command, arguments);
  arguments.host.roles = AllRoles();
  command
      .add_option("--services", arguments.host.roles,
                  fmt::format("What runs there: {}", Join(kRoles, ",")))
      ->delimiter(',')
      ->check(CLI::IsMember(AllRoles()))
      ->default_str("all");
  command
      .add_option("--robots", arguments.host.grant.robots,
                  "Only of these robots may they send anything; without it of all")
      ->delimiter(',')
      ->check(NameOf("robot", ""));
  command
      .add_option(
          "--topics", arguments.host.grant.topics,
          "Other topics and actions that they may use: those of a driver's robot, as /r1/scan")
      ->delimiter(',')
      ->check(NameOf("topic", "/"));
  AddDays(command, arguments);
  OnCall(command, arguments, exit_code, [&] {
    Add(arguments.keystore, arguments.host, arguments.days);
    return Moved(arguments);
  });
}

void AddRotate(CLI::App& app, Arguments& arguments, int& exit_code) {
  CLI::App& command = *app.add_subcommand("rotate",
                                          "Makes new keys and permissions, as this version of "
                                          "conav has them; the old ones no longer count");
  command.add_option("HOST", arguments.host.name, "Only of this host")->check(NameOf("host", ".-"));
  AddKeystore(command, arguments);
  AddDays(command, arguments);
  OnCall(command, arguments, exit_code, [&] {
    std::vector<std::string> hosts;
    if (!arguments.host.name.empty()) hosts.push_back(arguments.host.name);
    Rotate(arguments.keystore, hosts, arguments.days);
    return std::string(kListChanged);
  });
}

void AddRevoke(CLI::App& app, Arguments& arguments, int& exit_code) {
  CLI::App& command =
      *app.add_subcommand("revoke", "Takes a host out: its certificates no longer count");
  command.add_option("HOST", arguments.host.name, "Which")->required()->check(NameOf("host", ".-"));
  AddKeystore(command, arguments);
  OnCall(command, arguments, exit_code, [&] {
    Revoke(arguments.keystore, arguments.host.name);
    return std::string(kListChanged);
  });
}

}  // namespace
}  // namespace conav::keystore

int main(int argc, char** argv) {
  using namespace conav::keystore;
  CLI::App app{"Keys and permissions of DDS security, laid out as SROS2 does.", kProgram};
  app.require_subcommand(1);
  Arguments arguments;
  int exit_code = 0;
  AddInit(app, arguments, exit_code);
  AddAdd(app, arguments, exit_code);
  AddRotate(app, arguments, exit_code);
  AddRevoke(app, arguments, exit_code);
  if (conav::NamesUnknownCommand(app, argc, argv)) {
    return conav::Refused(kProgram, fmt::format("there is no command '{}'", argv[1]));
  }
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return exit_code;
}
