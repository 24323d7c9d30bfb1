#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace conav::operators {

/// The files of the page, read into memory once; `x.js.gz` beside `x.js` is its compressed form.
class WebFiles {
 public:
  struct File {
    std::string type;  // Content-Type
    std::shared_ptr<const std::string> plain;
    std::shared_ptr<const std::string> gzip;  // may be null
    std::string etag;
    std::string gzip_etag;
    bool immutable = false;  // its name changes with its content
  };

  /// Throws StartupError: the folder holds no index.html, a file cannot be read.
  explicit WebFiles(const std::filesystem::path& folder);

  /// `path` as in the URL, "/" is the page itself. Null when there is no such file.
  const File* Find(std::string_view path) const;

 private:
  void Add(const std::filesystem::path& folder, const std::filesystem::path& path);

  std::map<std::string, File, std::less<>> files_;  // by URL path
};

/// Where the page lies when nobody says otherwise: share/conav/console beside the program's folder.
std::filesystem::path DefaultWebFolder();

}  // namespace conav::operators
