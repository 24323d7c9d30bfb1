#pragma once

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/named.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"

/// The command line of a program that ends by itself: results go to standard output or into files,
/// everything else to standard error.
namespace conav {

/// A file and its name in messages: {"--data", "my.pb.zst"}.
struct FileOption {
  std::string option;
  std::filesystem::path path;  // empty = not given
};

/// Rejects an output that is also an input (which would be lost) or another output, however the
/// paths are written. "-", devices and pipes may repeat.
/// Errors: kInvalidArgument, naming both options.
[[nodiscard]] Result<void> CheckDistinct(const std::vector<FileOption>& inputs,
                                         const std::vector<FileOption>& outputs);

/// Prints "conav train: <what went wrong>" on standard error and gives exit code 1.
int Failed(std::string_view program, const Error& error);

/// The same for wrong usage: exit code 2.
int Refused(std::string_view program, const std::string& reason);

/// "conav train: warning: <text>" on standard error.
void Warn(std::string_view program, const std::string& text);

/// 0, or the exit code of Failed.
int ExitCode(std::string_view program, const Result<void>& done);

/// Errors: kIo when standard output is full or closed.
[[nodiscard]] Result<void> WriteStandardOutput(std::string_view text);

/// Writes the file `path`; "-" is standard output, an empty path nowhere. Errors: kIo.
[[nodiscard]] Result<void> WriteOutput(const std::filesystem::path& path, std::string_view text);

/// The same for JsonText.
[[nodiscard]] Result<void> WriteJsonOutput(const std::filesystem::path& path,
                                           const nlohmann::ordered_json& document);

/// Call first: checks that every input can be read, that no output is an input or another output, and
/// that WriteOutput can write each of them. Returns 0, or prints the reason and returns 2, so a named
/// file that is missing is wrong use in every program.
int CheckFiles(std::string_view program, const std::vector<FileOption>& inputs,
               const std::vector<FileOption>& outputs);

/// A whole number from 0 to 2^64 - 1. (CLI11 alone reads -1 as the largest of them.)
CLI::Validator WholeNumber();

CLI::Validator NotNan();

/// A number from `low` to `high`; bounds every numeric option. (CLI::Range alone lets nan through.)
template <class Number>
CLI::Validator Between(Number low, Number high) {
  return CLI::Range(low, high) & NotNan();
}

/// An option whose help shows the default.
template <class Value>
CLI::Option* AddShown(CLI::App& app, const std::string& name, Value& value,
                      const std::string& help) {
  return app.add_option(name, value, help)->capture_default_str();
}
/// The same, a number within these bounds.
template <class Value, class Number>
CLI::Option* AddNumber(CLI::App& app, const std::string& name, Value& value,
                       const std::string& help, Number low, Number high) {
  return AddShown(app, name, value, help)->check(Between(low, high));
}
/// The same for a seed.
CLI::Option* AddSeed(CLI::App& app, const std::string& name, std::uint64_t& value,
                     const std::string& help);

/// An option whose value is the Name() of one of `choices`, which its help lists; `value` is an Enum, or
/// an optional one with `default_text` in the help.
template <class Enum, class Value, std::size_t kCount>
void AddChoice(CLI::App& app, const std::string& option, Value& value,
               const std::array<Enum, kCount>& choices, const std::string& help,
               std::string_view default_text = {}) {
  const auto read = [option, &value, &choices](const std::string& name) {
    const auto found = FindNamed(choices, name);
    if (!found) {
      throw CLI::ValidationError(
          fmt::format("{} {}: not one of {}", option, name, Join(Names(choices), ", ")));
    }
    value = *found;
  };
  if constexpr (std::is_same_v<Enum, Value>) default_text = Name(value);
  app.add_option_function<std::string>(option, read,
                                       fmt::format("{}: {}", help, Join(Names(choices), ", ")))
      ->default_str(std::string(default_text));
}

/// Parses the command line. Nothing when the program goes on, else its exit code: 0 after --help, 2
/// for wrong use, which is explained on standard error.
[[nodiscard]] std::optional<int> Parse(CLI::App& app, int argc, const char* const* argv);

/// A file that can be written at the end; "-" is standard output, an empty path nowhere.
CLI::Validator WritableFile();

/// Whether the command line begins with a word that is not a subcommand of `app`. CLI11 would only
/// report that a subcommand is missing.
bool NamesUnknownCommand(const CLI::App& app, int argc, const char* const* argv);

}  // namespace conav
