#include "common/console/option_checks.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <limits>

#include "common/runtime/file.h"

namespace conav {
namespace {

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

CLI::Validator WholeNumber() {
  return {[](const std::string& text) { return RefusalOfNumber(text); }, "NONNEGATIVE"};
}

CLI::Validator WritableFile() {
  return {[](const std::string& path) { return RefusalOfOutput(path); }, "FILE"};
}

bool NamesUnknownCommand(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2 || argv[1][0] == '-') return false;
  const auto is_first = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
  return app.get_subcommands(is_first).empty();
}

}  // namespace conav
