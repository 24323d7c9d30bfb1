#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/result.h"

namespace conav {

/// A file and what names it in messages: {"--data", "my.pb.zst"}.
struct FileOption {
  std::string option;
  std::filesystem::path path;  // empty = not given
};

/// Refuses an output that is one of the inputs, which would be lost, or another output, however the
/// two paths are written. "-", devices and pipes may come twice.
/// Errors: kInvalidArgument, naming both options.
[[nodiscard]] Result<void> CheckDistinct(const std::vector<FileOption>& inputs,
                                         const std::vector<FileOption>& outputs);

}  // namespace conav

/// How a program that ends by itself speaks to its user: results on standard output or into files,
/// all else on standard error.
namespace conav {

/// Prints "conav train: <what went wrong>" on standard error and gives exit code 1.
int Failed(std::string_view program, const Error& error);

/// The same for wrong use: exit code 2.
int Refused(std::string_view program, const std::string& reason);

/// "conav train: warning: <text>" on standard error.
void Warn(std::string_view program, const std::string& text);

/// 0, or what Failed gives.
int ExitCode(std::string_view program, const Result<void>& done);

/// Errors: kIo when it is full or closed.
[[nodiscard]] Result<void> WriteStandardOutput(std::string_view text);

/// Writes into the file `path`; "-" is standard output, empty nowhere. Errors: kIo.
[[nodiscard]] Result<void> WriteOutput(const std::filesystem::path& path, std::string_view text);

/// JsonText, likewise.
[[nodiscard]] Result<void> WriteJsonOutput(const std::filesystem::path& path,
                                           const nlohmann::ordered_json& document);

/// Before long work rather than after it: whether no output is an input or another output, and
/// WriteOutput can write to all of them. 0; else prints the reason and gives 2.
int CheckFiles(std::string_view program, const std::vector<FileOption>& inputs,
               const std::vector<FileOption>& outputs);

}  // namespace conav

/// Checks for options of a command line, with messages that a person can read.
namespace conav {

/// A whole number from 0 to 2^64 - 1: CLI11 takes -1 for the largest of them.
CLI::Validator WholeNumber();

/// A file that can be written when the work is done; "-" is standard output, nothing nowhere.
CLI::Validator WritableFile();

/// Whether the command line begins with a word that is no subcommand of `app`: CLI11 would only say
/// that it wants one.
bool NamesUnknownCommand(const CLI::App& app, int argc, const char* const* argv);

}  // namespace conav
