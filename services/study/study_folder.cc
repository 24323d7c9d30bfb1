#include "study/study_folder.h"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <thread>

#include "common/runtime/file.h"
#include "common/runtime/text.h"

namespace conav::study {
namespace {

constexpr std::size_t kMostText = 80;

/// Quotes `word` for a shell.
std::string Quoted(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=,./:+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string inner;
  for (const char c : word) {
    if (c == '\'') inner += "'\\'";
    inner += c;
  }
  return fmt::format("'{}'", inner);
}

std::string Processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown processor";
}

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
  return "it has entries that this one lacks";
}

Result<void> CheckSameDesign(const fs::path& file, const nlohmann::ordered_json& design) {
  const auto text = ReadFile(file);
  if (!text) return tl::unexpected(text.error());
  const auto there = nlohmann::json::parse(*text, nullptr, false);
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

}  // namespace

Provenance DescribeRun(int argc, const char* const* argv) {
  Provenance provenance{.command = "conav study"};
  for (int i = 1; i < argc; ++i) provenance.command += fmt::format(" {}", Quoted(argv[i]));
  const char* commit = std::getenv("CONAV_COMMIT");
  provenance.commit = commit != nullptr ? commit : "unknown";
  provenance.date = fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)));
  provenance.machine =
      fmt::format("{}, {} cores", Processor(), std::thread::hardware_concurrency());
  return provenance;
}

statistics::ReportSection ProvenanceSection(const Provenance& provenance,
                                            const nlohmann::ordered_json& design) {
  statistics::ReportSection section{.title = "Provenance", .header = {"", ""}};
  section.rows = {{"command", provenance.command},
                  {"commit", provenance.commit},
                  {"report written", provenance.date},
                  {"on", provenance.machine}};
  for (const auto& [key, value] : design.items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (!text.empty() && text.size() <= kMostText) section.rows.push_back({key, text});
  }
  return section;
}

std::string Fingerprint(const nlohmann::ordered_json& design) { return Sha256Hex(design.dump()); }

Result<StudyFolder> StudyFolder::Open(const fs::path& path, const nlohmann::ordered_json& design) {
  if (const auto made = MakeFolder(path); !made) return tl::unexpected(made.error());
  std::error_code ignored;
  const bool known = fs::exists(path / kDesignFile, ignored);
  // Check before creating the lock: in a foreign folder it would be a stray file.
  const auto fits = known ? CheckSameDesign(path / kDesignFile, design) : CheckEmpty(path);
  if (!fits) return tl::unexpected(fits.error());
  const auto lock = Lock(path / kLockFile);
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

fs::path StudyFolder::person(const std::string& subject) const {
  return path_ / "people" / (subject + ".yaml");
}

fs::path StudyFolder::runs(const std::string& episode) const { return path_ / "runs" / episode; }

Result<std::map<std::string, std::string>> StudyFolder::ReadRecords(const std::string& kind) const {
  std::map<std::string, std::string> texts;
  if (auto made = MakeFolder(path_ / kind); !made) return tl::unexpected(made.error());
  for (const auto& entry : fs::directory_iterator(path_ / kind)) {
    if (entry.path().extension() != ".json") continue;
    auto text = ReadFile(entry.path());
    if (!text) return tl::unexpected(text.error());
    texts.emplace(entry.path().stem().string(), *std::move(text));
  }
  return texts;
}

Result<void> StudyFolder::WriteRecord(const std::string& kind, const std::string& name,
                                      const nlohmann::ordered_json& record) const {
  return WriteJsonFile(path_ / kind / (name + ".json"), record);
}

Error StudyFolder::NotARecord(const std::string& kind, const std::string& name,
                              const std::string& reason) const {
  return {ErrorCode::kMalformed, fmt::format("{}: is not a record of this study ({}); delete it "
                                             "and the same command runs this piece again",
                                             (path_ / kind / (name + ".json")).string(), reason)};
}

Result<void> StudyFolder::Write(const fs::path& relative, std::string_view text) const {
  const fs::path file = path_ / relative;
  return MakeFolder(file.parent_path()).and_then([&] { return WriteFile(file, text); });
}

}  // namespace conav::study
