#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>

#include "common/msg/perception_model.h"
#include "nhpm/config.h"

namespace conav::nhpm {

/// The models of a service: one for everybody, and those of persons with one of their own. Follows
/// changes of their files, and logs each change and each bad file.
///
/// A caller keeps the model it holds: a reload only changes later results of For().
/// Threads: safe to call concurrently; Refresh() from one thread only.
class ServedModels {
 public:
  /// Throws StartupError when the model for everybody cannot be loaded or the folder of persons
  /// does not exist. Logs a person's bad file.
  explicit ServedModels(const NhpmConfig& config);

  /// Reloads changed files. If a file, or the whole folder of persons, cannot be read, the loaded
  /// model stays. A person whose file is gone gets the model for everybody.
  void Refresh();

  /// The model of that person; the one for everybody if the name is empty or unknown.
  std::shared_ptr<PerceptionModel> For(const std::string& person) const;
  std::size_t persons() const;

 private:
  /// Two files of one size may be written within one tick of the file system's clock; then the
  /// inode differs, because WriteWeightsFile renames.
  struct Stamp {
    std::int64_t time_ns = 0;
    std::uint64_t size = 0;
    std::uint64_t inode = 0;
    bool operator==(const Stamp&) const = default;
  };
  struct Source {
    std::string model;  // one of kPerceptionModels
    std::filesystem::path file;
    bool tried = false;
    std::optional<Stamp> seen;  // of the last attempt
    std::shared_ptr<PerceptionModel> loaded;
  };

  static std::optional<Stamp> StampOf(const std::filesystem::path& file);
  Result<void> Load(Source& source);
  void RefreshOne(const std::string& person, Source& source);
  void RefreshPersons();
  void Publish();

  const GlpfParameters glpf_;
  const std::filesystem::path person_folder_;
  Source everybody_;
  std::map<std::string, Source> persons_;
  std::error_code folder_error_;  // of the last check
  mutable std::mutex mutex_;      // guards all below
  std::shared_ptr<PerceptionModel> model_;
  std::map<std::string, std::shared_ptr<PerceptionModel>> model_of_person_;
};

}  // namespace conav::nhpm
