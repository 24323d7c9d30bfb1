#include "nhpm/model/load_model.h"

#include "nhpm/model/perception_network.h"
#include "nhpm/model/weights_file.h"

namespace conav::nhpm {

std::filesystem::path ShippedWeights() {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return program.parent_path().parent_path() / "share/conav/models/default.nhpm";
}

std::filesystem::path WeightsOrShipped(const std::filesystem::path& weights) {
  return weights.empty() ? ShippedWeights() : weights;
}

Result<std::shared_ptr<PerceptionModel>> LoadPerceptionModel(PerceptionModelKind kind,
                                                             const std::filesystem::path& weights,
                                                             const GlpfParameters& glpf) {
  if (kind == PerceptionModelKind::kGlpf) return std::make_shared<Glpf>(glpf);
  return ReadWeightsFile(WeightsOrShipped(weights))
      .map([](const NetworkModel& model) -> std::shared_ptr<PerceptionModel> {
        return std::make_shared<PerceptionNetwork>(model);
      });
}

}  // namespace conav::nhpm
