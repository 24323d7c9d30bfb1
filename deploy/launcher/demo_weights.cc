#include "launcher/demo_weights.h"

#include <fmt/format.h>

#include "launcher/demo_world.h"
#include "nhpm/model/load_model.h"
#include "nhpm/model/weights_file.h"
#include "sim/world/world_site.h"

namespace conav::launcher {
namespace {

std::filesystem::path PersonFile(const DemoOptions& options) {
  return options.person.empty() ? "" : options.person_weights / (options.person + ".nhpm");
}

Result<void> CheckOne(const DemoOptions& options, const char* option,
                      const std::filesystem::path& file) {
  if (file.empty()) return {};
  const auto model = nhpm::ReadWeightsFile(file);
  if (!model) {
    return Fail(model.error().code, fmt::format("{} {}", option, model.error().text));
  }
  const auto site = sim::MakeSite(WorldOptionsOf(options, 0));  // see CheckWorlds
  if (model->rows == 0 || !site) return {};
  const OccupancyGrid& map = site->truth;
  if (model->rows == map.rows() && model->columns == map.columns()) return {};
  return Fail(ErrorCode::kInvalidArgument,
              fmt::format("{} {}: is for maps of {} x {} cells; this run's have {} x {}", option,
                          file.string(), model->rows, model->columns, map.rows(), map.columns()));
}

}  // namespace

Result<void> CheckWeights(const DemoOptions& options) {
  return CheckOne(options, "--weights", options.weights).and_then([&] {
    return CheckOne(options, "--person-weights", PersonFile(options));
  });
}

std::string WeightsChecksum(const DemoOptions& options) {
  if (options.model != kNhpmModel) return "";
  const std::filesystem::path file = PersonFile(options);
  const auto model =
      nhpm::ReadWeightsFile(file.empty() ? nhpm::WeightsOrShipped(options.weights) : file);
  return model ? nhpm::ChecksumOf(*model) : "";
}

}  // namespace conav::launcher
