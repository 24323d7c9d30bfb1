#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>

#include "operator/recording/mcap_file.h"

namespace conav::bag {

namespace fs = std::filesystem;

namespace {

/// `cause`: an errno.
tl::unexpected<Error> IoError(const std::filesystem::path& path, int cause,
                              ErrorCode code = ErrorCode::kIo) {
  return Fail(code, fmt::format("{}: {}", path.string(), std::strerror(cause)));
}

/// The number of a file as NumberedFile names it; 0 for other names.
int NumberOf(const fs::path& file, const fs::path& first) {
  const std::string stem = file.stem().string();
  const std::string prefix = first.stem().string() + "-";
  if (file.extension() != first.extension()) return 0;
  if (file.filename() == first.filename()) return 1;
  int number = 0;
  const char* end = stem.data() + stem.size();
  const char* begin = stem.data() + std::min(prefix.size(), stem.size());
  const bool is_number =
      stem.starts_with(prefix) && std::from_chars(begin, end, number).ptr == end && begin != end;
  return is_number ? number : 0;
}

}  // namespace

Result<InputFile> InputFile::Open(const std::filesystem::path& path) {
  FileDescriptor descriptor(path, O_RDONLY);
  if (descriptor.number() < 0) {
    return IoError(path, errno, errno == ENOENT ? ErrorCode::kNotFound : ErrorCode::kIo);
  }
  struct stat status {};
  if (fstat(descriptor.number(), &status) != 0) return IoError(path, errno);
  if (!S_ISREG(status.st_mode)) return Fail(ErrorCode::kIo, path.string() + ": is no file");
  return InputFile(path, std::move(descriptor), static_cast<std::uint64_t>(status.st_size));
}

Result<Bytes> InputFile::Read(std::uint64_t offset, std::uint64_t size) const {
  if (offset > size_ || size > size_ - offset) {
    return Fail(ErrorCode::kMalformed,
                fmt::format("{}: {} bytes from byte {} on are not in this file of {} bytes",
                            path_.string(), size, offset, size_));
  }
  Bytes bytes(size);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = pread(descriptor_.number(), bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return IoError(path_, errno);
    if (count == 0) return Fail(ErrorCode::kIo, path_.string() + ": became shorter");
    done += static_cast<std::size_t>(count);
  }
  return bytes;
}

fs::path NumberedFile(const fs::path& file, int number) {
  if (number == 1) return file;
  const std::string stem = file.stem().string();
  return file.parent_path() / fmt::format("{}-{}{}", stem, number, file.extension().string());
}

std::map<int, fs::path> FilesLike(const fs::path& first) {
  std::map<int, fs::path> files;
  std::error_code ignored;
  const auto folder = first.has_parent_path() ? first.parent_path() : ".";
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (const int number = NumberOf(entry.path(), first); number > 0) files[number] = entry.path();
  }
  return files;
}

fs::path FollowingFile(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t dash = stem.rfind('-');
  const fs::path first = file.parent_path() / (stem.substr(0, dash) + file.extension().string());
  const int number = dash == std::string::npos ? 1 : NumberOf(file, first);
  // recording-3.mcap after recording-2.mcap; but a recording's own name may end in a number.
  const fs::path counted = NumberedFile(first, number + 1);
  std::error_code ignored;
  return number >= 2 && fs::exists(counted, ignored) ? counted : NumberedFile(file, 2);
}

std::string McapReader::FactOf(std::string_view record, const std::string& name) const {
  for (const Metadata& metadata : contents_.metadata) {
    if (metadata.name != record) continue;
    const auto value = metadata.values.find(name);
    if (value != metadata.values.end()) return value->second;
  }
  return "";
}

void McapReader::NoteMissing(const std::string& what) {
  if (what.empty()) return;
  missing_ += (missing_.empty() ? "" : "; ") + what;
}

void McapReader::GoOnWith(McapReader part) {
  const std::string name = part.file_.path().filename().string();
  if (!contents_.cut_off.empty() && part.start_time() > end_time() && message_count() > 0) {
    NoteMissing(fmt::format("{} begins {:.1f} s later", name,
                            static_cast<double>(part.start_time() - end_time()) * 1e-9));
  }
  if (!part.cut_off().empty()) NoteMissing(fmt::format("{}: {}", name, part.cut_off()));
  next_ = std::make_unique<McapReader>(std::move(part));
  all_topics_ = std::make_unique<std::vector<RecordedTopic>>(*topics_);
  const auto same_in_all = [this](const RecordedTopic& topic) {
    return std::ranges::find_if(*all_topics_, [&](const RecordedTopic& other) {
      return other.channel.topic == topic.channel.topic && other.schema.name == topic.schema.name;
    });
  };
  for (const RecordedTopic& topic : next_->topics()) {
    const auto same = same_in_all(topic);
    if (same == all_topics_->end())
      all_topics_->push_back(topic);
    else
      same->message_count += topic.message_count;
  }
  std::ranges::stable_sort(*all_topics_, {}, [](const auto& topic) { return topic.channel.topic; });
  for (const RecordedTopic& topic : *topics_) shared_topics_[&topic] = &*same_in_all(topic);
  for (const RecordedTopic& topic : next_->topics()) shared_topics_[&topic] = &*same_in_all(topic);
}

std::uint64_t McapReader::start_time() const {
  const bool is_empty = contents_.statistics.message_count == 0;
  return is_empty && next_ ? next_->start_time() : contents_.statistics.start_time;
}

std::uint64_t McapReader::end_time() const {
  return next_ && next_->message_count() > 0 ? next_->end_time() : contents_.statistics.end_time;
}

Result<fs::path> RecordingOf(const fs::path& run) {
  std::error_code ignored;
  if (!fs::is_directory(run, ignored)) return run;
  const auto files = FilesLike(run / "recording.mcap");
  if (!files.empty()) return files.begin()->second;
  return Fail(ErrorCode::kNotFound,
              fmt::format("{}: no recording.mcap in it: no run folder, or it ran with "
                          "--no-recording",
                          run.string()));
}

}  // namespace conav::bag
