#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "common/runtime/result.h"
#include "nhpm/model/weights_file.h"
#include "support/temporary_folder.h"

namespace conav::test {

/// A network with weights from a seed, not trained on anything.
inline nhpm::NetworkModel UntrainedNetwork(std::uint64_t seed, int rows = 0, int columns = 0,
                                           int width = 16) {
  nhpm::NetworkModel model;
  model.version = "untrained " + std::to_string(seed);
  model.weights = nhpm::InitialWeights({width}, seed, -1.0F);
  model.rows = rows;
  model.columns = columns;
  model.data_origin = "synthetic";
  return model;
}

/// The same for rasters.
inline nhpm::NetworkModel UntrainedEncoderDecoder(std::uint64_t seed, int width = 4) {
  nhpm::NetworkModel model;
  model.name = Name(PerceptionModelKind::kEncoderDecoder);
  model.version = "untrained " + std::to_string(seed);
  model.weights = nhpm::InitialWeights({width, nhpm::Architecture::kEncoderDecoder}, seed, -1.0F);
  model.data_origin = "synthetic";
  return model;
}

/// A folder for weights files, removed at the end.
class WeightsFolder : public TemporaryFolder {
 public:
  /// Writes `model` as `name`.nhpm and returns the file's path.
  std::string Write(const std::string& name, const nhpm::NetworkModel& model) const {
    const std::filesystem::path file = *this / (name + ".nhpm");
    const auto written = nhpm::WriteWeightsFile(file, model);
    DEMAND(written, file.string());
    return file.string();
  }
};

}  // namespace conav::test
