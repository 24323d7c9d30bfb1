#pragma once

#include <CLI/CLI.hpp>

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
