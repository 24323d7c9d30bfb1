#include <fmt/core.h>
#include <openssl/rand.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>

#include "common/cli/cli.h"
#include "common/msg/robot.h"
#include "common/runtime/text.h"
#include "operator/gateway/access.h"

// conav-token: who may open the console, and until when.

namespace conav::operators {
namespace {

constexpr const char* kProgram = "conav token";
constexpr double kDayS = 24.0 * 3600.0;

struct TokenArguments {
  std::string name;
  std::string role;
  double days = 90.0;
  std::string file = "tokens.json";
};

/// 128 random bits in hexadecimal: too many to guess, so that a plain hash is enough to hide them.
std::string NewToken() {
  std::array<unsigned char, 16> bytes{};
  DEMAND(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1);
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

std::string DateOf(double wall_s) {
  return UtcTime(static_cast<std::time_t>(wall_s), "%Y-%m-%d %H:%M UTC");
}

/// Of one that NameOf gives.
console::Role RoleNamed(const std::string& name) {
  for (const console::Role role : {console::ROLE_OBSERVER, console::ROLE_OPERATOR}) {
    if (NameOf(role) == name) return role;
  }
  return console::ROLE_ADMIN;
}

/// A file that does not exist has no tokens.
Result<std::vector<AccessToken>> ReadOrBegin(const std::string& file) {
  auto tokens = ReadTokens(file);
  if (tokens || tokens.error().code != ErrorCode::kNotFound) return tokens;
  return std::vector<AccessToken>();
}

int Add(const TokenArguments& arguments) {
  auto tokens = ReadOrBegin(arguments.file);
  if (!tokens) return Failed(kProgram, tokens.error());
  if (std::ranges::find(*tokens, arguments.name, &AccessToken::name) != tokens->end()) {
    return Refused(kProgram, fmt::format("{} has a token in {}: revoke it first", arguments.name,
                                         arguments.file));
  }
  const std::string token = NewToken();
  const double ends_s = WallSeconds() + arguments.days * kDayS;
  tokens->push_back({arguments.name, RoleNamed(arguments.role), Sha256Hex(token), ends_s});
  if (const auto written = WriteTokens(arguments.file, *tokens); !written) {
    return Failed(kProgram, written.error());
  }
  fmt::print(stderr, "{} is {} until {}. The token is shown only now; open ADDRESS/#token=TOKEN:\n",
             arguments.name, arguments.role, DateOf(ends_s));
  return ExitCode(kProgram, WriteStandardOutput(token + "\n"));
}

int List(const TokenArguments& arguments) {
  if (const int code = CheckFiles(kProgram, {{"--file", arguments.file}}, {}); code != 0)
    return code;
  const auto tokens = ReadTokens(arguments.file);
  if (!tokens) return Failed(kProgram, tokens.error());
  std::string text;
  for (const AccessToken& token : *tokens) {
    text += fmt::format("{:<20} {:<10} {} {}\n", token.name, NameOf(token.role),
                        token.ends_s > WallSeconds() ? "until" : "ended", DateOf(token.ends_s));
  }
  return ExitCode(kProgram, WriteStandardOutput(text));
}

int Revoke(const TokenArguments& arguments) {
  if (const int code = CheckFiles(kProgram, {{"--file", arguments.file}}, {}); code != 0)
    return code;
  auto tokens = ReadTokens(arguments.file);
  if (!tokens) return Failed(kProgram, tokens.error());
  const auto is_named = [&](const AccessToken& token) { return token.name == arguments.name; };
  if (std::erase_if(*tokens, is_named) == 0) {
    return Refused(kProgram, fmt::format("{} has no token in {}", arguments.name, arguments.file));
  }
  return ExitCode(kProgram, WriteTokens(arguments.file, *tokens));
}

CLI::Validator TokenName() {
  return {[](const std::string& name) {
            const bool is_good = IsEntityName(name) && name.size() <= 40;
            return is_good ? std::string() : "a name is 1 to 40 of A-Z a-z 0-9 _";
          },
          "", ""};
}

constexpr const char* kAbout =
    R"(Adds, lists and revokes the tokens with which people open the operator's console.

Each person gets a token of their own, with a role and an end. The file keeps names, roles, ends and
SHA-256 sums, never the tokens; operator.console.token_file names it. A running service follows it:
pages whose token is revoked are closed within two seconds. docs/console.md says more.

Exit codes: 0 done; 1 the file is malformed or cannot be written; 2 wrong use, or no such file.

Examples:
  conav token add anna --role operator --days 30
  conav token list
  conav token revoke anna)";

}  // namespace
}  // namespace conav::operators

int main(int argc, char** argv) {
  using namespace conav::operators;
  CLI::App app(kAbout, "conav token");
  app.require_subcommand(1);
  TokenArguments arguments;
  const auto add_command = [&](const char* command, const char* about, bool names) {
    CLI::App* added = app.add_subcommand(command, about);
    if (names) {
      added->add_option("name", arguments.name, "Whose it is")
          ->required()
          ->type_name("NAME")
          ->check(TokenName());
    }
    added->add_option("--file", arguments.file, "The file of tokens")->capture_default_str();
    return added;
  };
  CLI::App* add = add_command("add", "Make a token and print it", true);
  add->add_option("--role", arguments.role, "An observer watches, stops robots and writes notes")
      ->required()
      ->check(CLI::IsMember({"observer", "operator", "admin"}));
  add->add_option("--days", arguments.days, "How long it counts")
      ->capture_default_str()
      ->check(conav::Between(0.0, 3650.0));
  CLI::App* list = add_command("list", "Show names, roles and ends", false);
  add_command("revoke", "Make a token count no longer", true);
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return add->parsed() ? Add(arguments) : list->parsed() ? List(arguments) : Revoke(arguments);
}
