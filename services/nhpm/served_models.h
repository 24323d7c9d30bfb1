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

/// The models that a service answers with: one for everybody, and those of persons who have one of
/// their own. Follows the files that they come from; says each change, and what is wrong with a
/// file, in the log.
///
/// Who holds a model keeps it: a reload changes what For() gives from then on.
/// Threads: safe to use from several; Refresh() from one.
class ServedModels {
 public:
  /// Throws StartupError when the model for everybody cannot be loaded or the folder of persons is
  /// none. A person's bad file is logged.
  explicit ServedModels(const NhpmConfig& config);

  /// Looks whether files changed and loads those that did. What cannot be read leaves the model
  /// that it had, which holds for the whole folder of persons too. A person whose file is gone gets
  /// the model for everybody.
  void Refresh();

  /// The model of that person; of everybody for an empty or unknown name.
  std::shared_ptr<PerceptionModel> For(const std::string& person) const;
  std::size_t persons() const;

 private:
  /// Two files of one size may be written within one tick of the file system's clock; then the
  /// inode differs, as WriteWeightsFile renames.
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
    std::optional<Stamp> seen;  // of the last try
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
  std::error_code folder_error_;  // of the last look
  mutable std::mutex mutex_;      // guards all below
  std::shared_ptr<PerceptionModel> model_;
  std::map<std::string, std::shared_ptr<PerceptionModel>> model_of_person_;
};

}  // namespace conav::nhpm
