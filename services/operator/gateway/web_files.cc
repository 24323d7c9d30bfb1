#include "operator/gateway/web_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "common/runtime/file.h"
#include "common/runtime/result.h"
#include "common/runtime/sha256.h"

namespace conav::operators {
namespace {

constexpr std::array<std::pair<std::string_view, const char*>, 9> kTypes{{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".ico", "image/x-icon"},
    {".json", "application/json"},
    {".webmanifest", "application/manifest+json"},
    {".woff2", "font/woff2"},
}};

const char* TypeOf(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  for (const auto& [ending, type] : kTypes) {
    if (extension == ending) return type;
  }
  return "application/octet-stream";
}

std::shared_ptr<const std::string> Read(const std::filesystem::path& file) {
  auto text = ReadFile(file);
  if (!text) throw StartupError(fmt::format("console page: {}", text.error().text));
  return std::make_shared<const std::string>(*std::move(text));
}

/// Without compressed ones. None where there is no such folder.
std::vector<std::filesystem::path> FilesBelow(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::exists(folder)) return files;
  try {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file() && entry.path().extension() != ".gz") {
        files.push_back(entry.path());
      }
    }
  } catch (const std::filesystem::filesystem_error& error) {
    throw StartupError(fmt::format("console page: {}", error.what()));
  }
  return files;
}

}  // namespace

WebFiles::WebFiles(const std::filesystem::path& folder) {
  for (const auto& path : FilesBelow(folder)) Add(folder, path);
  if (!files_.contains("/index.html")) {
    throw StartupError(fmt::format("console page: {} holds no index.html", folder.string()));
  }
  files_["/"] = files_["/index.html"];
}

void WebFiles::Add(const std::filesystem::path& folder, const std::filesystem::path& path) {
  File file;
  file.type = TypeOf(path);
  file.plain = Read(path);
  const std::filesystem::path compressed = path.string() + ".gz";
  if (std::filesystem::exists(compressed)) file.gzip = Read(compressed);
  const std::string digits = Sha256Hex(*file.plain).substr(0, 16);
  file.etag = fmt::format("\"{}\"", digits);
  file.gzip_etag = fmt::format("\"{}-gz\"", digits);
  const std::string url = fmt::format("/{}", path.lexically_relative(folder).generic_string());
  file.immutable = url.starts_with("/assets/");
  files_[url] = std::move(file);
}

const WebFiles::File* WebFiles::Find(std::string_view path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

std::filesystem::path DefaultWebFolder() {
  std::error_code unknown;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return program.parent_path().parent_path() / "share/conav/console";
}

}  // namespace conav::operators
