#include "common/runtime/file_options.h"

#include <fmt/format.h>

#include <span>

namespace conav {
namespace fs = std::filesystem;
namespace {

bool CanBeLost(const fs::path& path) {
  std::error_code ignored;
  const auto status = fs::status(path, ignored);
  return !path.empty() && path != "-" && (!fs::exists(status) || fs::is_regular_file(status));
}

/// Also where it does not exist yet.
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

}  // namespace conav
