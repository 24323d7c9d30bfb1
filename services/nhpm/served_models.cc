#include <fmt/core.h>
#include <sys/stat.h>

#include <set>

#include "common/msg/robot.h"
#include "common/runtime/log.h"
#include "nhpm/nhpm_service.h"

namespace conav::nhpm {
namespace fs = std::filesystem;
namespace {

void ReportServing(const std::string& person, const ModelIdentity& identity, const fs::path& file) {
  LOG_INFO("serving", "person", person.empty() ? "everybody" : person, "model", identity.name,
           "version", identity.version, "checksum", identity.checksum, "file", file.string());
}

}  // namespace

ServedModels::ServedModels(const NhpmConfig& config)
    : glpf_(config.glpf), person_folder_(config.person_weights) {
  everybody_.model = config.model;
  if (config.model != PerceptionModelKind::kGlpf) everybody_.file = config.WeightsFile();
  if (const auto loaded = Load(everybody_); !loaded) throw StartupError(loaded.error().text);
  ReportServing("", everybody_.loaded->identity(), everybody_.file);
  std::error_code ignored;
  if (!person_folder_.empty() && !fs::is_directory(person_folder_, ignored)) {
    throw StartupError(
        fmt::format("nhpm.person_weights = {} is not a folder", person_folder_.string()));
  }
  RefreshPersons();
  Publish();
}

std::optional<ServedModels::Stamp> ServedModels::StampOf(const fs::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return std::nullopt;
  return Stamp{status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec,
               static_cast<std::uint64_t>(status.st_size), status.st_ino};
}

/// Takes the stamp first: if the file changes during the read, the next check reads it again.
Result<void> ServedModels::Load(Source& source) {
  source.tried = true;
  source.seen = StampOf(source.file);
  auto model = LoadPerceptionModel(source.model, source.file, glpf_);
  if (!model) return tl::unexpected(model.error());
  source.loaded = *std::move(model);
  return {};
}

void ServedModels::Refresh() {
  if (!everybody_.file.empty()) RefreshOne("", everybody_);
  RefreshPersons();
  Publish();
}

void ServedModels::RefreshOne(const std::string& person, Source& source) {
  if (source.tried && StampOf(source.file) == source.seen) return;
  const auto before = source.loaded;
  if (const auto loaded = Load(source); !loaded) {
    LOG_ERROR("weights rejected", "person", person.empty() ? "everybody" : person, "reason",
              loaded.error().text, "still_serving",
              before ? before->identity().checksum : "the model for everybody");
    return;
  }
  if (before && before->identity() == source.loaded->identity()) return;
  ReportServing(person, source.loaded->identity(), source.file);
}

void ServedModels::RefreshPersons() {
  if (person_folder_.empty()) return;
  std::set<std::string> present;
  std::error_code error;
  fs::directory_iterator entries(person_folder_, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    const fs::path& file = entries->path();
    const std::string person = file.stem().string();
    if (file.extension() != ".nhpm" || !IsEntityName(person)) continue;
    present.insert(person);
    const auto [source, added] = persons_.try_emplace(
        person, Source{PerceptionModelKind::kNhpm, file, false, std::nullopt, nullptr});
    RefreshOne(person, source->second);
  }
  if (error != folder_error_ && error) {
    LOG_ERROR("cannot read the persons' weights", "folder", person_folder_.string(), "reason",
              error.message(), "still_serving", persons_.size());
  }
  folder_error_ = error;
  if (error) return;
  std::erase_if(persons_, [&](const auto& entry) {
    if (present.count(entry.first) > 0) return false;
    LOG_INFO("weights removed; using the model for everybody", "person", entry.first);
    return true;
  });
}

void ServedModels::Publish() {
  const std::lock_guard lock(mutex_);
  model_ = everybody_.loaded;
  model_of_person_.clear();
  for (const auto& [person, source] : persons_) {
    if (source.loaded) model_of_person_[person] = source.loaded;
  }
}

std::shared_ptr<PerceptionModel> ServedModels::For(const std::string& person) const {
  const std::lock_guard lock(mutex_);
  const auto found = model_of_person_.find(person);
  return found == model_of_person_.end() ? model_ : found->second;
}

std::size_t ServedModels::persons() const {
  const std::lock_guard lock(mutex_);
  return model_of_person_.size();
}

}  // namespace conav::nhpm
