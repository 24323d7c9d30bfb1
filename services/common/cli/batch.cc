#include "common/cli/batch.h"

#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include "common/runtime/file.h"
#include "common/runtime/result.h"
#include "common/runtime/text.h"

namespace conav {

namespace fs = std::filesystem;

void Batch::AddOptions(CLI::App& app, const std::string& pieces) {
  app.add_option("--records", folder_,
                 fmt::format("Keep the {} in this folder as they are done: the same command "
                             "resumes",
                             pieces));
  app.add_flag("--slurm", submit_,
               fmt::format("Do the {} as jobs of a Slurm array; --records is a folder that all "
                           "nodes see, and SBATCH_... variables choose partition, account and time",
                           pieces));
  app.add_option("--piece", piece_, "Of such a job: its piece")->group("");
}

fs::path Batch::FileOf(std::size_t piece, const std::string& extension) const {
  return folder_ / "pieces" / (std::to_string(piece) + extension);
}

void Batch::Start(std::size_t pieces) const {
  if ((submit_ || piece_) && !is_kept()) throw StartupError("--slurm needs --records FOLDER");
  if (!is_kept()) return;
  std::error_code error;
  fs::create_directories(folder_ / "pieces", error);
  if (error) throw StartupError(fmt::format("--records {}: {}", folder_.string(), error.message()));
  CheckCommand();
  if (!submit_) return;
  std::vector<std::string> words = CommandWithout({"--slurm"});
  const fs::path batch = fs::path(words[0]).parent_path() / "conav-batch";
  words.insert(words.begin(), {batch.string(), folder_.string(), std::to_string(pieces)});
  BecomeProgram(words);
}

void Batch::CheckCommand() const {
  const auto words = CommandWithout({"--slurm", "--piece", "--records", "--out", "--json", "--csv",
                                     "--svg", "--threads", "--jobs"});
  const std::string command = fmt::format("{} {}\n", fs::path(words[0]).filename().string(),
                                          Join(std::span(words).subspan(1), " "));
  const fs::path file = folder_ / "command.txt";
  const auto there = ReadFile(file);
  if (there && *there != command) {
    throw StartupError(fmt::format("--records {} belongs to another command, {}", folder_.string(),
                                   there->substr(0, there->find('\n'))));
  }
  if (there) return;
  if (const auto written = WriteFile(file, command); !written) {
    throw StartupError(written.error().text);
  }
}

std::vector<std::string> CommandWithout(const std::vector<std::string>& omit) {
  std::vector<std::string> words{fs::read_symlink("/proc/self/exe").string()};
  const std::string line = ReadFile("/proc/self/cmdline").value_or("");
  bool is_value = false;
  for (std::size_t begin = line.find('\0') + 1; begin < line.size();) {
    const std::size_t end = line.find('\0', begin);
    const std::string word = line.substr(begin, end - begin);
    begin = end + 1;
    const bool is_omitted = std::ranges::any_of(omit, [&](const std::string& option) {
      return word == option || word.starts_with(option + "=");
    });
    if (!is_omitted && !is_value) words.push_back(word);
    is_value = is_omitted && word != "--slurm" && word.find('=') == std::string::npos;
  }
  return words;
}

void BecomeProgram(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  std::fflush(nullptr);
  execv(arguments[0], arguments.data());
  throw StartupError(fmt::format("{}: cannot run it: {}", words[0], std::strerror(errno)));
}

}  // namespace conav
