#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "common/runtime/file_options.h"
#include "common/runtime/result.h"

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
