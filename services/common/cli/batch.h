#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT: CLI11 calls it so
class App;
}

namespace conav {

/// A command that consists of pieces (mazes, waves, trainings) and keeps each in a file once it is
/// done: FOLDER/pieces/<number><extension>. The same command resumes, and jobs of a Slurm array may
/// do the pieces instead.
///
/// With --slurm the process becomes conav-batch, which submits itself as this command with --piece
/// once for each piece that has no file, waits, and then becomes this command without --slurm: it
/// finds all pieces, or does those itself whose jobs failed.
class Batch {
 public:
  /// Adds --records and --slurm. `pieces`: what they are, for the help.
  void AddOptions(CLI::App& app, const std::string& pieces);

  /// Whether pieces have files.
  bool is_kept() const { return !folder_.empty(); }
  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path FileOf(std::size_t piece, const std::string& extension) const;
  /// Does this piece alone.
  const std::optional<std::size_t>& piece() const { return piece_; }

  /// Call once the command line is known to be right, before the work: with --slurm it only returns
  /// if that cannot be. Makes the folder. Throws StartupError.
  void Start(std::size_t pieces) const;

 private:
  /// The folder is of this command, whatever its outputs, threads and pieces. Throws StartupError.
  void CheckCommand() const;

  std::filesystem::path folder_;
  bool submit_ = false;
  std::optional<std::size_t> piece_;
};

/// The words of this process's command, its program by its whole path first, without options that
/// `omit` names (each with its value, or as --option=value).
std::vector<std::string> CommandWithout(const std::vector<std::string>& omit);

/// Becomes the program `words[0]`. Throws StartupError where there is none.
[[noreturn]] void BecomeProgram(const std::vector<std::string>& words);

}  // namespace conav
