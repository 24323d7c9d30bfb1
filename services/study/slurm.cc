#include <fmt/core.h>
#include <poll.h>

#include <utility>

#include "common/runtime/file.h"
#include "common/runtime/text.h"
#include "launcher/process.h"
#include "study/report_page.h"
#include "study/study_run.h"

namespace conav::study {
namespace {

namespace fs = std::filesystem;

/// Slurm's default MaxArraySize is 1001, and indices stay below it.
constexpr std::size_t kArraySize = 1000;

/// The part of `pending` in [first, first + kArraySize), counted from `first`.
std::vector<std::size_t> Block(const std::vector<std::size_t>& pending, std::size_t first) {
  std::vector<std::size_t> block;
  for (const std::size_t index : pending) {
    if (index >= first && index < first + kArraySize) block.push_back(index - first);
  }
  return block;
}

std::string ScriptOf(const SlurmRun& slurm, std::size_t first) {
  std::vector<std::string> words;
  for (const std::string& word : slurm.command) words.push_back(Quoted(word));
  return fmt::format("#!/bin/sh\nexec {} --piece $(({} + SLURM_ARRAY_TASK_ID))\n", Join(words, " "),
                     first);
}

std::size_t CountRecords(const fs::path& folder) {
  std::error_code none;
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (entry.is_regular_file(none) && entry.path().extension() != ".partial") ++count;
  }
  return count;
}

/// Submits an array and waits until its last job has ended. Jobs of a node that dies are Slurm's to
/// queue again.
class SlurmArray {
 public:
  SlurmArray(const std::vector<std::size_t>& indices, const fs::path& script,
             const fs::path& folder)
      : sbatch_("sbatch",
                {"sbatch", "--parsable", "--wait", "--requeue", "--job-name=conav",
                 fmt::format("--array={}", Join(indices, ",")),
                 fmt::format("--chdir={}", fs::current_path().string()),
                 fmt::format("--output={}/%A_%a.out", folder.string()), script.string()},
                folder / "sbatch.out") {}

  bool Ended() { return sbatch_.Poll(); }
  /// Of what sbatch printed; empty = it submitted nothing.
  std::string Id() const {
    const auto text = ReadFile(sbatch_.log());
    if (!text || text->find_first_of("0123456789") != 0) return "";
    return text->substr(0, text->find_first_of(";\n"));
  }
  void Cancel() {
    launcher::Process scancel("scancel", {"scancel", Id()}, sbatch_.log().string() + ".cancel");
    while (!scancel.Poll()) poll(nullptr, 0, 20);
  }

 private:
  launcher::Process sbatch_;
};

}  // namespace

void AddSlurmOptions(CLI::App& app, SlurmRun& slurm, int argc, const char* const* argv) {
  app.add_flag("--slurm", slurm.submit,
               "Run each as a job of a Slurm array, instead of here; --out is a folder that all "
               "nodes see, and SBATCH_... variables choose partition, account and time");
  app.add_option("--piece", slurm.piece, "Of such a job: its piece")->group("");
  slurm.command = {fs::read_symlink("/proc/self/exe").string()};
  slurm.command.insert(slurm.command.end(), argv + 1, argv + argc);
}

Result<void> RunOnSlurm(const SlurmRun& slurm, const std::vector<std::size_t>& pending,
                        std::size_t of, const fs::path& folder, const std::string& pieces,
                        const StopToken& stop) {
  ProgressLine line;
  std::size_t shown = 0;
  for (std::size_t first = 0; first < of; first += kArraySize) {
    const std::vector<std::size_t> block = Block(pending, first);
    if (block.empty()) continue;
    const fs::path script = folder / fmt::format("slurm/{}.sh", first);
    std::error_code none;  // WriteFile says what is wrong
    fs::create_directories(script.parent_path(), none);
    if (auto written = WriteFile(script, ScriptOf(slurm, first)); !written) return written;
    SlurmArray array(block, script, script.parent_path());
    while (!array.Ended()) {
      poll(nullptr, 0, 200);
      if (stop.stop_requested()) {
        array.Cancel();
        return {};
      }
      const std::size_t done = CountRecords(folder / pieces);
      if (std::exchange(shown, done) == done) continue;
      line.Show(fmt::format("Slurm job {}: {} of {} {}", array.Id(), done, of, pieces));
    }
    if (array.Id().empty()) {
      const auto output = launcher::LastLines(folder / "slurm/sbatch.out", 3);
      return Fail(ErrorCode::kUnavailable, fmt::format("sbatch: {}", Join(output, " ")));
    }
  }
  return {};
}

}  // namespace conav::study
