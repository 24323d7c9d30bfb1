#pragma once

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "nhpm/model/weights_file.h"

namespace conav::test {

/// A network with weights from a seed, not trained on anything.
inline nhpm::NetworkModel UntrainedNetwork(std::uint64_t seed, int rows = 0, int columns = 0) {
  nhpm::NetworkModel model;
  model.version = "untrained " + std::to_string(seed);
  model.weights = nhpm::InitialWeights({16}, seed, -1.0F);
  model.rows = rows;
  model.columns = columns;
  model.data_origin = "synthetic";
  return model;
}

/// A folder for weights files, removed at the end.
class WeightsFolder {
 public:
  WeightsFolder() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "conav-weights-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()) != nullptr);
    path_ = pattern;
  }
  ~WeightsFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WeightsFolder(const WeightsFolder&) = delete;
  WeightsFolder& operator=(const WeightsFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Writes `model` as `name`.nhpm and returns the file's path.
  std::string Write(const std::string& name, const nhpm::NetworkModel& model) const {
    const std::filesystem::path file = path_ / (name + ".nhpm");
    REQUIRE(nhpm::WriteWeightsFile(file, model));
    return file.string();
  }

 private:
  std::filesystem::path path_;
};

}  // namespace conav::test
