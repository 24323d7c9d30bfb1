#include "study/record_store.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "common/runtime/file.h"
#include "common/runtime/text.h"

namespace conav::study {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDesignFile = "study.json";
constexpr const char* kLockFile = "lock";

Result<void> MakeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (!error && fs::is_directory(path, error)) return {};
  return Fail(ErrorCode::kIo, fmt::format("{}: cannot create this folder: {}", path.string(),
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

Result<void> CheckSameDesign(const fs::path& file, const nlohmann::ordered_json& design) {
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  const auto there = nlohmann::ordered_json::parse(*text, nullptr, false);
  if (!there.is_object() || !there.contains("fingerprint") || !there.contains("design")) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: is not the design of a study", file.string()));
  }
  if (there["fingerprint"] == Fingerprint(design)) return {};
  return Fail(ErrorCode::kRefused,
              fmt::format("{} belongs to another study: {}; choose another --out",
                          file.parent_path().string(), Difference(there["design"], design)));
}

/// A new folder may only hold our own lock and what a killed run left of our first file: a study
/// does not mix with other files.
Result<void> CheckEmpty(const fs::path& path) {
  for (const auto& entry : fs::directory_iterator(path)) {
    const std::string name = entry.path().filename().string();
    if (name == kLockFile || name.starts_with(std::string(kDesignFile) + ".")) continue;
    return Fail(ErrorCode::kRefused,
                fmt::format("{} is not empty and contains no study", path.string()));
  }
  return {};
}

Result<void> Take(const std::string& text, const std::string& name,
                  const StudyFolder::RecordReader& read) {
  try {
    return read(name, nlohmann::json::parse(text));
  } catch (const nlohmann::json::exception& error) {
    return Fail(ErrorCode::kMalformed, error.what());
  }
}

}  // namespace

std::string Difference(const nlohmann::ordered_json& there, const nlohmann::ordered_json& wanted) {
  constexpr std::size_t kMostText = 60;
  const auto text = [](const std::string& value) {
    return value.size() <= kMostText ? value : value.substr(0, kMostText) + "...";
  };
  const auto changes = nlohmann::ordered_json::diff(there, wanted);
  if (changes.empty()) return "";
  const std::string path = changes[0]["path"];
  const nlohmann::ordered_json::json_pointer pointer(path);
  const std::string name = path.empty() ? path : path.substr(1);
  if (!there.contains(pointer)) return name + " is missing there";
  if (!wanted.contains(pointer)) return name + " is only there";
  return fmt::format("{} is {} there, {} here", name, text(there[pointer].dump()),
                     text(wanted[pointer].dump()));
}

std::string Fingerprint(const nlohmann::ordered_json& design) { return Sha256Hex(design.dump()); }

Result<StudyFolder> StudyFolder::Open(const fs::path& path, const nlohmann::ordered_json& design,
                                      bool lock_it) {
  if (const auto made = MakeFolder(path); !made) return tl::unexpected(made.error());
  std::error_code ignored;
  const bool known = fs::exists(path / kDesignFile, ignored);
  // Check before creating the lock: in a foreign folder it would be a stray file.
  const auto fits = known ? CheckSameDesign(path / kDesignFile, design) : CheckEmpty(path);
  if (!fits) return tl::unexpected(fits.error());
  const auto lock = lock_it ? Lock(path / kLockFile) : Result<int>(-1);
  if (!lock) return tl::unexpected(lock.error());
  StudyFolder folder(path, *lock);
  const nlohmann::ordered_json document{{"fingerprint", Fingerprint(design)}, {"design", design}};
  const auto ready = known ? Result<void>() : folder.Write(kDesignFile, JsonText(document));
  if (!ready) return tl::unexpected(ready.error());
  return folder;
}

StudyFolder::StudyFolder(StudyFolder&& other) noexcept
    : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}

StudyFolder::~StudyFolder() {
  if (lock_ >= 0) close(lock_);
}

Result<void> StudyFolder::ReadRecords(const std::string& kind, const RecordReader& read) const {
  if (auto made = MakeFolder(path_ / kind); !made) return made;
  for (const auto& entry : fs::directory_iterator(path_ / kind)) {
    if (entry.path().extension() != ".json") continue;
    const auto text = ReadFile(entry.path());
    if (!text) return tl::unexpected(text.error());
    const auto taken = Take(*text, entry.path().stem().string(), read);
    if (taken) continue;
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: is not a record of this study ({}); delete it and the same "
                            "command runs this piece again",
                            entry.path().string(), taken.error().text));
  }
  return {};
}

Result<void> StudyFolder::Write(const fs::path& relative, std::string_view text) const {
  const fs::path file = path_ / relative;
  return MakeFolder(file.parent_path()).and_then([&] { return WriteFile(file, text); });
}

}  // namespace conav::study
