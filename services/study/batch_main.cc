// conav-batch: the --slurm of commands whose pieces are files (common/cli/batch.h). Not for people:
// conav-batch FOLDER PIECES COMMAND...

#include <cctype>
#include <cstdlib>

#include "common/cli/batch.h"
#include "common/cli/cli.h"
#include "study/study_run.h"

namespace conav::study {
namespace {

constexpr const char* kProgram = "conav --slurm";

/// Those of `of` pieces without a file.
std::vector<std::size_t> Pending(const std::filesystem::path& pieces, std::size_t of) {
  std::vector<bool> is_done(of);
  for (const auto& entry : std::filesystem::directory_iterator(pieces)) {
    const bool is_partial = entry.path().extension() == ".partial";  // of a job that was killed
    const bool is_numbered =
        std::isdigit(static_cast<unsigned char>(entry.path().filename().c_str()[0])) != 0;
    if (is_partial || !is_numbered) continue;
    const std::size_t piece = std::strtoull(entry.path().filename().c_str(), nullptr, 10);
    if (piece < of) is_done[piece] = true;
  }
  std::vector<std::size_t> pending;
  for (std::size_t piece = 0; piece < of; ++piece) {
    if (!is_done[piece]) pending.push_back(piece);
  }
  return pending;
}

int Main(const std::filesystem::path& path, std::size_t of,
         const std::vector<std::string>& command) {
  InstallStopSignals();
  const std::filesystem::path folder = std::filesystem::absolute(path);
  SlurmRun slurm;
  slurm.command = command;
  const StopToken& stop = ProcessStopToken();
  const auto done = RunOnSlurm(slurm, Pending(folder / "pieces", of), of, folder, "pieces", stop);
  if (!done) return Failed(kProgram, done.error());
  if (stop.stop_requested()) {
    return Failed(kProgram, {ErrorCode::kUnavailable, "interrupted; the same command resumes"});
  }
  BecomeProgram(command);
}

}  // namespace
}  // namespace conav::study

int main(int argc, char** argv) {
  if (argc < 4) return conav::Refused("conav-batch", "started by --slurm of other commands");
  try {
    return conav::study::Main(argv[1], std::strtoull(argv[2], nullptr, 10),
                              {argv + 3, argv + argc});
  } catch (const conav::StartupError& error) {
    return conav::Failed("conav --slurm", {conav::ErrorCode::kUnavailable, error.what()});
  }
}
