#include "study/study_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "common/runtime/file.h"
#include "common/runtime/json.h"
#include "common/runtime/sha256.h"

namespace conav::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDesignFile = "study.json";
constexpr const char* kLockFile = "lock";
constexpr const char* kEpisodes = "episodes";

Result<void> MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return {};
  return Fail(ErrorCode::kIo, fmt::format("{}: cannot make this folder: {}", path.string(),
                                          error ? error.message() : "it is a file"));
}

Result<int> Lock(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (descriptor < 0) {
    return Fail(ErrorCode::kIo,
                fmt::format("{}: cannot open: {}", file.string(), std::strerror(errno)));
  }
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  close(descriptor);
  return Fail(ErrorCode::kRefused,
              fmt::format("{} is in use by another conav study", file.parent_path().string()));
}

/// The first entry in which two designs differ, with both values.
std::string Difference(const nlohmann::json& there, const nlohmann::ordered_json& wanted) {
  constexpr std::size_t kMostText = 60;
  const auto text = [](const std::string& value) {
    return value.size() <= kMostText ? value : value.substr(0, kMostText) + "...";
  };
  for (const auto& [key, value] : wanted.items()) {
    if (!there.contains(key)) return key + " is missing there";
    const nlohmann::json plain = nlohmann::json::parse(value.dump());
    if (there[key] == plain) continue;
    return fmt::format("{} is {} there, {} here", key, text(there[key].dump()), text(plain.dump()));
  }
  return "it holds what this one does not";
}

Result<void> CheckSameDesign(const fs::path& file, const nlohmann::ordered_json& design) {
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  const auto there = nlohmann::json::parse(*text, nullptr, false);
  if (!there.is_object() || !there.contains("fingerprint") || !there.contains("design")) {
    return Fail(ErrorCode::kMalformed, fmt::format("{}: is no study's design", file.string()));
  }
  if (there["fingerprint"] == Fingerprint(design)) return {};
  return Fail(ErrorCode::kRefused,
              fmt::format("{} belongs to another study: {}; choose another --out",
                          file.parent_path().string(), Difference(there["design"], design)));
}

/// A new folder may hold nothing but our own lock: we do not mix with other files.
Result<void> CheckEmpty(const fs::path& path) {
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.path().filename() == kLockFile) continue;
    return Fail(ErrorCode::kRefused,
                fmt::format("{} is not empty and holds no study", path.string()));
  }
  return {};
}

}  // namespace

std::string Fingerprint(const nlohmann::ordered_json& design) { return Sha256Hex(design.dump()); }

Result<StudyFolder> StudyFolder::Open(const fs::path& path, const nlohmann::ordered_json& design) {
  if (const auto made = MakeFolder(path); !made) return tl::unexpected(made.error());
  std::error_code ignored;
  const bool known = fs::exists(path / kDesignFile, ignored);
  // Before the lock, whose file would be the first of somebody else's folder.
  const auto fits = known ? CheckSameDesign(path / kDesignFile, design) : CheckEmpty(path);
  if (!fits) return tl::unexpected(fits.error());
  const auto lock = Lock(path / kLockFile);
  if (!lock) return tl::unexpected(lock.error());
  StudyFolder folder(path, *lock);
  const nlohmann::ordered_json document{{"fingerprint", Fingerprint(design)}, {"design", design}};
  auto ready = known ? Result<void>() : folder.Write(kDesignFile, JsonText(document));
  ready = ready.and_then([&] { return MakeFolder(path / kEpisodes); }).and_then([&] {
    return folder.LoadRecords();
  });
  if (!ready) return tl::unexpected(ready.error());
  return folder;
}

StudyFolder::StudyFolder(StudyFolder&& other) noexcept
    : path_(std::move(other.path_)),
      lock_(std::exchange(other.lock_, -1)),
      records_(std::move(other.records_)) {}

StudyFolder::~StudyFolder() {
  if (lock_ >= 0) close(lock_);
}

fs::path StudyFolder::person(const std::string& subject) const {
  return path_ / "people" / (subject + ".yaml");
}

fs::path StudyFolder::runs(const std::string& episode) const { return path_ / "runs" / episode; }

Result<void> StudyFolder::LoadRecords() {
  for (const auto& entry : fs::directory_iterator(path_ / kEpisodes)) {
    if (entry.path().extension() != ".json") continue;
    const auto text = ReadFile(entry.path());
    if (!text) return tl::unexpected(text.error());
    auto record = RecordFromJson(*text);
    if (!record) {
      return Fail(ErrorCode::kMalformed,
                  fmt::format("{}: is no record of an episode ({}); without it the episode runs "
                              "again",
                              entry.path().string(), record.error().text));
    }
    records_.insert_or_assign(record->name, *std::move(record));
  }
  return {};
}

Result<void> StudyFolder::Save(const EpisodeRecord& record) {
  auto written = WriteJsonFile(path_ / kEpisodes / (record.name + ".json"), study::ToJson(record));
  if (written) records_.insert_or_assign(record.name, record);
  return written;
}

Result<void> StudyFolder::Write(const fs::path& relative, std::string_view text) const {
  const fs::path file = path_ / relative;
  return MakeFolder(file.parent_path()).and_then([&] { return WriteFile(file, text); });
}

}  // namespace conav::study
