#include "launcher/run_folder.h"

#include <fmt/core.h>

#include <fstream>

#include "common/runtime/result.h"
#include "common/runtime/text.h"

namespace conav::launcher {

std::string RunId(std::chrono::system_clock::time_point now, std::uint64_t seed) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(now);
  return fmt::format("{}-seed{}", UtcTime(seconds, "%Y%m%d-%H%M%S"), seed);
}

RunFolder::RunFolder(const std::filesystem::path& parent, std::chrono::system_clock::time_point now,
                     std::uint64_t seed) {
  const std::string id = RunId(now, seed);
  std::error_code error;
  std::filesystem::create_directories(parent, error);
  // create_directory() is atomic, so two runs that start in the same second get two folders.
  bool made = false;
  for (int attempt = 1; !error && !made && attempt < 1000; ++attempt) {
    path_ = parent / (attempt == 1 ? id : fmt::format("{}-{}", id, attempt));
    made = std::filesystem::create_directory(path_, error);
  }
  for (const char* part : {"config", "logs", "state"}) {
    if (!error) std::filesystem::create_directory(path_ / part, error);
  }
  if (error || !made) {
    throw StartupError(
        fmt::format("{}: cannot create a run folder here: {}", parent.string(), error.message()));
  }
  path_ = std::filesystem::absolute(path_).lexically_normal();
}

std::filesystem::path RunFolder::config(const std::string& service) const {
  return path_ / "config" / (service + ".yaml");
}

std::filesystem::path RunFolder::log(const std::string& service) const {
  return path_ / "logs" / (service + ".log");
}

std::filesystem::path RunFolder::decisions(const std::string& planner) const {
  return path_ /
         (planner == "planner" ? "decisions.pb.zst" : fmt::format("decisions-{}.pb.zst", planner));
}

void LimitLog(const std::filesystem::path& log, std::uintmax_t limit) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(log, error);
  if (error || size <= limit) return;
  std::filesystem::path before = log;
  before += ".1";
  std::filesystem::copy_file(log, before, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) std::filesystem::resize_file(log, 0, error);
}

void RunFolder::Write(const std::filesystem::path& file, const std::string& text) const {
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) throw StartupError(fmt::format("{}: cannot write", file.string()));
}

}  // namespace conav::launcher
