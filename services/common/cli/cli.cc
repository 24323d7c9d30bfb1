#include "common/cli/cli.h"

#include <fmt/core.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>

#include "common/runtime/file.h"
#include "common/runtime/text.h"

namespace conav {
namespace fs = std::filesystem;
namespace {

bool CanBeLost(const fs::path& path) {
  std::error_code ignored;
  const auto status = fs::status(path, ignored);
  return !path.empty() && path != "-" && (!fs::exists(status) || fs::is_regular_file(status));
}

/// Also works for files that do not exist yet.
bool IsSameFile(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  const fs::path whole_a = fs::weakly_canonical(fs::absolute(a, error), error);
  if (error) return false;
  const fs::path whole_b = fs::weakly_canonical(fs::absolute(b, error), error);
  return !error && whole_a == whole_b;
}

Result<void> CheckNotAmong(std::span<const FileOption> others, const FileOption& output,
                           const char* what_it_is) {
  if (!CanBeLost(output.path)) return {};
  for (const FileOption& other : others) {
    if (other.path.empty() || other.path == "-" || !IsSameFile(other.path, output.path)) continue;
    return Fail(ErrorCode::kInvalidArgument,
                fmt::format("{} {}: is {} {}, too", output.option, output.path.string(), what_it_is,
                            other.option));
  }
  return {};
}

std::string RefusalOfNumber(const std::string& text) {
  std::uint64_t number = 0;
  const char* end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  if (parsed.ec == std::errc{} && parsed.ptr == end) return "";
  return fmt::format("'{}' is not a whole number from 0 to {}", text,
                     std::numeric_limits<std::uint64_t>::max());
}

std::string RefusalOfOutput(const std::string& path) {
  if (path.empty() || path == "-") return "";
  const auto writable = CheckWritable(path);
  return writable ? "" : writable.error().text;
}

}  // namespace

Result<void> CheckDistinct(const std::vector<FileOption>& inputs,
                           const std::vector<FileOption>& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto checked = CheckNotAmong(inputs, outputs[i], "the input").and_then([&] {
      return CheckNotAmong(std::span(outputs).first(i), outputs[i], "the output");
    });
    if (!checked) return checked;
  }
  return {};
}

int Failed(std::string_view program, const Error& error) {
  std::fputs(fmt::format("{}: {}\n", program, error.text).c_str(), stderr);
  return 1;
}

int Refused(std::string_view program, const std::string& reason) {
  Failed(program, {ErrorCode::kInvalidArgument, reason});
  return 2;
}

void Warn(std::string_view program, const std::string& text) {
  std::fputs(fmt::format("{}: warning: {}\n", program, text).c_str(), stderr);
}

int ExitCode(std::string_view program, const Result<void>& done) {
  return done ? 0 : Failed(program, done.error());
}

Result<void> WriteStandardOutput(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return {};
  return Fail(ErrorCode::kIo,
              fmt::format("standard output: cannot write: {}", std::strerror(errno)));
}

Result<void> WriteOutput(const std::filesystem::path& path, std::string_view text) {
  if (path.empty()) return {};
  return path == "-" ? WriteStandardOutput(text) : WriteFile(path, text);
}

Result<void> WriteJsonOutput(const std::filesystem::path& path,
                             const nlohmann::ordered_json& document) {
  return WriteOutput(path, JsonText(document));
}

int CheckFiles(std::string_view program, const std::vector<FileOption>& inputs,
               const std::vector<FileOption>& outputs) {
  if (const auto distinct = CheckDistinct(inputs, outputs); !distinct) {
    return Refused(program, distinct.error().text);
  }
  for (const auto& [option, path] : inputs) {
    if (path.empty()) continue;
    if (const auto readable = CheckReadable(path); !readable) {
      return Refused(program, fmt::format("{} {}", option, readable.error().text));
    }
  }
  for (const auto& [option, path] : outputs) {
    if (path.empty() || path == "-") continue;
    if (const auto writable = CheckWritable(path); !writable) {
      return Refused(program, fmt::format("{} {}", option, writable.error().text));
    }
  }
  return 0;
}

CLI::Validator WholeNumber() {
  return {[](const std::string& text) { return RefusalOfNumber(text); }, "NONNEGATIVE"};
}

CLI::Option* AddSeed(CLI::App& app, const std::string& name, std::uint64_t& value,
                     const std::string& help) {
  return app.add_option(name, value, help)->check(WholeNumber())->capture_default_str();
}

CLI::Validator NotNan() {
  return {[](const std::string& text) {
            return std::isnan(std::strtod(text.c_str(), nullptr)) ? text + " is not a number" : "";
          },
          ""};
}

CLI::Validator WritableFile() {
  return {[](const std::string& path) { return RefusalOfOutput(path); }, "FILE"};
}

std::optional<int> Parse(CLI::App& app, int argc, const char* const* argv) {
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
}

bool NamesUnknownCommand(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2 || argv[1][0] == '-') return false;
  const auto is_first = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  return app.get_subcommands(is_first).empty();
}

}  // namespace conav
